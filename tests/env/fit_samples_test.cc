#include "env/fit_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace sandwright {
namespace {

HeightMap Bump(double x_m, double y_m) {
  HeightMap map(60, 60, 0.002, 0.05f);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const double dx = (column + 0.5) * 0.002 - x_m, dy = (row + 0.5) * 0.002 - y_m;
      map.At(row, column) += static_cast<float>(0.02 * std::exp(-(dx * dx + dy * dy) / 2e-4));
    }
  }
  return map;
}

TEST(FitSamples, PlacingNowhereElseIsResampling) {
  const HeightMap map = Bump(0.05, 0.07);
  EXPECT_EQ(Place(map, {}, 0.004).height_m, Resample(map, 0.004).height_m);
  // By whole cells of the map, and by quarter turns, no height is made up.
  const HeightMap shifted = Place(map, {0, 0.008, -0.004}, 0.004), as_is = Resample(map, 0.004);
  for (int row = 0; row < 29; ++row) {
    for (int column = 2; column < 30; ++column)
      ASSERT_NEAR(shifted.At(row, column), as_is.At(row + 1, column - 2), 1e-7);
  }
  EXPECT_EQ(shifted.valid[shifted.Index(0, 1)], 0);
  EXPECT_EQ(shifted.valid[shifted.Index(29, 10)], 0);
  EXPECT_EQ(shifted.valid[shifted.Index(28, 2)], 1);
  const HeightMap turned = Place(map, {std::numbers::pi / 2, 0, 0}, 0.004);
  for (int row = 0; row < 30; ++row) {
    for (int column = 0; column < 30; ++column)
      ASSERT_NEAR(turned.At(column, 29 - row), as_is.At(row, column), 1e-6);
  }
}

TEST(FitSamples, ThePathStaysOnItsSandUnderAnyPlacement) {
  const double x_m = 0.05, y_m = 0.07;
  const HeightMap map = Bump(x_m, y_m);
  const ToolPath path = {{x_m, y_m, 0.04, 0.3}};
  for (const double turn_rad : {-0.8, 0.1, 2.0}) {
    const Placement placement{turn_rad, 0.001, -0.0013};
    const HeightMap placed = Place(map, placement, 0.004);
    const BladePose pose = Place(path, placement, map)[0];
    EXPECT_NEAR(pose.yaw_rad, 0.3 + turn_rad, 1e-12);
    const auto highest = std::ranges::max_element(placed.height_m) - placed.height_m.begin();
    EXPECT_NEAR(pose.x_m, (static_cast<double>(highest % 30) + 0.5) * 0.004, 0.0025);
    EXPECT_NEAR(pose.y_m, (static_cast<double>(highest / 30) + 0.5) * 0.004, 0.0025);
  }
}

}  // namespace
}  // namespace sandwright
