// What every bed of sand must satisfy after a stroke, whatever the stroke was.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/height_map.h"
#include "env/random_strokes.h"

namespace sandwright {

// Two strokes that are one another's mirror image part by the rounding of float, some thousand times larger
// where sand is just about to flow: two thousandths of a cell.
constexpr double kRounding_m = 1e-5;

inline double Volume(const HeightMap& map) {
  double sum = 0;
  for (const float h : map.height_m) sum += h;
  return sum * map.cell_size_m * map.cell_size_m;
}

inline double RmsDifference(const HeightMap& a, const HeightMap& b) {
  double squared = 0;
  for (size_t i = 0; i < a.size(); ++i)
    squared += std::pow(static_cast<double>(a.height_m[i]) - b.height_m[i], 2);
  return std::sqrt(squared / static_cast<double>(a.size()));
}

inline double LargestDifference(const HeightMap& a, const HeightMap& b) {
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, std::abs(static_cast<double>(a.height_m[i]) - b.height_m[i]));
  return largest;
}

// Finite, not below the floor, volume kept to a millionth.
inline void ExpectSane(const HeightMap& before, const HeightMap& after, const std::string& what) {
  for (const float h : after.height_m) ASSERT_TRUE(std::isfinite(h)) << what;
  EXPECT_GE(*std::ranges::min_element(after.height_m), 0) << what;
  EXPECT_NEAR(Volume(after) / Volume(before), 1, 1e-6) << what;
}

}  // namespace sandwright
