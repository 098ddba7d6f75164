// What every bed of sand must satisfy after a stroke, whatever the stroke was.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/height_map.h"

namespace sandwright {

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

// Largest slope at a face [rise over run]: the difference across it, and the mean of the four
// one-sided differences beside it; walls are level.
inline double SteepestFace(const HeightMap& map) {
  const auto at = [&](int row, int column) {
    return static_cast<double>(
        map.At(std::clamp(row, 0, map.rows - 1), std::clamp(column, 0, map.columns - 1)));
  };
  double steepest = 0;
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const auto slope = [&](int dr, int dc) {
        const auto across = [&](int r, int c) { return at(r + dc, c + dr) - at(r - dc, c - dr); };
        return std::hypot(at(row + dr, column + dc) - at(row, column),
                          (across(row, column) + across(row + dr, column + dc)) / 4);
      };
      if (column + 1 < map.columns) steepest = std::max(steepest, slope(0, 1));
      if (row + 1 < map.rows) steepest = std::max(steepest, slope(1, 0));
    }
  }
  return steepest / map.cell_size_m;
}

// Finite, not below the floor, volume kept to a millionth.
inline void ExpectSane(const HeightMap& before, const HeightMap& after, const std::string& what) {
  for (const float h : after.height_m) ASSERT_TRUE(std::isfinite(h)) << what;
  EXPECT_GE(*std::ranges::min_element(after.height_m), 0) << what;
  EXPECT_NEAR(Volume(after) / Volume(before), 1, 1e-6) << what;
}

}  // namespace sandwright
