#include "data/excavation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "data/base/error.h"

namespace sandwright {
namespace {

HeightMap Slope() {
  HeightMap map(160, 240, 0.005);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column)
      map.At(row, column) = 0.03f + 0.0003f * static_cast<float>(column);
  }
  return map;
}

TEST(Excavation, DrawsAllClassesAlikeWithinTheirLimits) {
  const HeightMap terrain = Slope();
  const ExcavationConfig config;
  std::map<char, int> classes;
  double lowest_x = 1e9, highest_x = 0;
  for (uint64_t i = 0; i < 1200; ++i) {
    RandomStream stream(7, 1, i);
    const Stroke stroke = DrawStroke(config, terrain, stream);
    CheckStroke(stroke, "drawn");
    ++classes[ComplexityClass(stroke)];
    EXPECT_GE(PathLength(stroke), config.shortest_m);
    Eigen::Vector3d low = stroke.control_points_m[0], high = low;
    for (const auto& p : stroke.control_points_m) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
      EXPECT_GE(p.z(), config.floor_margin_m);
      EXPECT_GE(p.x(), config.wall_margin_m);
      EXPECT_LE(p.x(), terrain.width_m() - config.wall_margin_m);
      EXPECT_GE(p.y(), config.wall_margin_m);
      EXPECT_LE(p.y(), terrain.depth_m() - config.wall_margin_m);
      const double depth = HeightAt(terrain, p.x(), p.y()) - p.z();
      if (std::string("CEF").find(ComplexityClass(stroke)) != std::string::npos) {
        EXPECT_GE(depth, -config.above_m - 1e-9);
        EXPECT_LE(depth, config.deepest_m + 1e-9);
      }
    }
    EXPECT_LE((high - low).maxCoeff(), config.cube_m + 1e-9);
    lowest_x = std::min(lowest_x, low.x());
    highest_x = std::max(highest_x, high.x());
  }
  ASSERT_EQ(classes.size(), 6u);
  for (const auto& [name, count] : classes) EXPECT_NEAR(count, 200, 60) << name;
  EXPECT_LT(lowest_x, 0.06);
  EXPECT_GT(highest_x, 1.14);
}

TEST(Excavation, SameStreamSameStroke) {
  RandomStream a(3, 1, 5), b(3, 1, 5);
  const Stroke first = DrawStroke({}, Slope(), a), second = DrawStroke({}, Slope(), b);
  EXPECT_EQ(first.control_points_m, second.control_points_m);
  EXPECT_EQ(first.degree, second.degree);
}

TEST(Excavation, RefusesABoxWithoutRoom) {
  RandomStream stream(1);
  try {
    DrawStroke({}, HeightMap(20, 20, 0.005, 0.05f), stream);
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(
        e.what(),
        "box of 0.1 x 0.1 m: strokes of at least 0.04 m, 0.035 m from the walls, need more "
        "than 0.11 m");
  }
  ExcavationConfig config;
  config.floor_margin_m = 0.2;  // above all sand: nothing can vary in depth, or be that deep
  EXPECT_THROW(
      {
        for (int i = 0; i < 20; ++i) DrawStroke(config, HeightMap(60, 60, 0.005, 0.05f), stream);
      },
      Error);
}

}  // namespace
}  // namespace sandwright
