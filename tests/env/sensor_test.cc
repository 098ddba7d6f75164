#include "env/sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace sandwright {
namespace {

// 60 x 80 cells of 5 mm: a slope of 0.2 along x.
HeightMap Slope() {
  HeightMap map(60, 80, 0.005);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column)
      map.At(row, column) = static_cast<float>(0.03 + 0.2 * (column + 0.5) * map.cell_size_m);
  }
  return map;
}

double Deviation(const HeightMap& a, const HeightMap& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += std::pow(a.height_m[i] - b.height_m[i], 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

HeightMap Look(const SensorConfig& config, uint64_t seed = 1) {
  RandomStream stream(seed);
  return Sense(Slope(), config, stream);
}

TEST(Sense, APerfectSensorShowsTheTruthAndDrawsNothing) {
  RandomStream stream(1), untouched(1);
  EXPECT_EQ(Sense(Slope(), {}, stream).height_m, Slope().height_m);
  EXPECT_EQ(stream.Next64(), untouched.Next64());
}

TEST(Sense, NoiseHasItsDeviation) {
  EXPECT_NEAR(Deviation(Look({.noise_m = 0.001}), Slope()), 0.001, 0.00004);  // 4800 draws
  EXPECT_EQ(Look({.noise_m = 0.001}).height_m, Look({.noise_m = 0.001}).height_m);
  EXPECT_NE(Look({.noise_m = 0.001}, 2).height_m, Look({.noise_m = 0.001}).height_m);
}

TEST(Sense, RegistrationShiftsTheWholeScan) {
  double square = 0;
  constexpr int kScans = 200;
  for (uint64_t seed = 0; seed < kScans; ++seed) {
    const HeightMap seen = Look({.registration_m = 0.004}, seed);
    const double rise = seen.At(30, 40) - Slope().At(30, 40);
    EXPECT_NEAR(seen.At(5, 20) - Slope().At(5, 20), rise, 1e-6);
    square += rise * rise;
  }
  EXPECT_NEAR(std::sqrt(square / kScans), 0.2 * 0.004, 0.2 * 0.004 * 0.15);  // sd of 200: 5 %
}

TEST(Sense, AnOffsetIsTheSameEverywhere) {
  const HeightMap seen = Look({.offset_m = 0.002});
  const float rise = seen.At(0, 0) - Slope().At(0, 0);
  EXPECT_NE(rise, 0);
  EXPECT_NEAR(seen.At(59, 79) - Slope().At(59, 79), rise, 1e-6);
}

TEST(Sense, HolesAreSpannedFromAroundThem) {
  HeightMap spiky = Slope();
  for (size_t i = 0; i < spiky.size(); ++i) spiky.height_m[i] += i % 2 ? 0.001f : -0.001f;
  RandomStream stream(3);
  const HeightMap seen = Sense(spiky, {.hole_share = 0.1, .hole_m = 0.03}, stream);
  size_t changed = 0;
  for (size_t i = 0; i < seen.size(); ++i) {
    changed += seen.height_m[i] != spiky.height_m[i];
    EXPECT_NEAR(seen.height_m[i], Slope().height_m[i], 0.0025);
  }
  const double share = static_cast<double>(changed) / static_cast<double>(seen.size());
  EXPECT_GT(share, 0.06);  // discs overlap and reach beyond the walls
  EXPECT_LT(share, 0.11);
  EXPECT_TRUE(seen.valid.empty());
}

TEST(Sense, HeightsAreWholeSteps) {
  for (const float h : Look({.noise_m = 0.001, .resolution_m = 0.002}).height_m)
    EXPECT_NEAR(h / 0.002 - std::round(h / 0.002), 0, 1e-4);
}

}  // namespace
}  // namespace sandwright
