#include "env/coarse_heightfield.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/sand_checks.h"

namespace sandwright {
namespace {

// 75 x 72 cells: 75 is no multiple of 2.
HeightMap Slope() {
  HeightMap map(72, 75, 0.004);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column)
      map.At(row, column) = 0.04f + 0.0004f * static_cast<float>(column) +
                            0.0005f * static_cast<float>((row * 7 + column * 3) % 5);
  }
  return map;
}

const Stroke kStroke{{{0.08, 0.10, 0.03}, {0.20, 0.18, 0.035}}, 1, 0.1};
const Stroke kToTheWall{{{0.20, 0.10, 0.01}, {0.285, 0.14, 0.01}}, 1, 0.1};

HeightMap Apply(int factor, const HeightMap& map, const Stroke& stroke) {
  std::vector<SandState> states{SandState(map)};
  const ToolPath path = SamplePath(stroke, 0.002);
  ApplyOnCoarseCells(Heightfield(), factor, states, std::span(&path, 1));
  return states[0].map();
}

TEST(CoarseHeightfield, OneCellIsTheHeightfieldItself) {
  std::vector<SandState> states{SandState(Slope())};
  Heightfield().Apply(states, std::span(&kStroke, 1));
  const HeightMap fine = Apply(1, Slope(), kStroke);
  EXPECT_EQ(fine.height_m, states[0].map().height_m);
  // Twice as large cells come near to it.
  EXPECT_LT(RmsDifference(Apply(2, Slope(), kStroke), fine), 0.3 * RmsDifference(Slope(), fine));
}

TEST(CoarseHeightfield, KeepsVolumeFloorAndWhatLiesFarAway) {
  for (const int factor : {2, 3, 4}) {
    for (const Stroke& stroke : {kStroke, kToTheWall}) {
      const HeightMap before = Slope(), after = Apply(factor, before, stroke);
      EXPECT_NEAR(Volume(after) / Volume(before), 1, 1e-6) << factor;
      EXPECT_GE(*std::ranges::min_element(after.height_m), 0);
      EXPECT_EQ(after.At(3, 3), before.At(3, 3));
      EXPECT_EQ(after.At(70, 10), before.At(70, 10));
    }
  }
}

TEST(CoarseHeightfield, ABatchIsItsStrokesOneByOneOnAnyNumberOfThreads) {
  const std::vector<Stroke> strokes{kStroke, kToTheWall, kStroke};
  std::vector<ToolPath> paths;
  for (const Stroke& stroke : strokes) paths.push_back(SamplePath(stroke, 0.002));
  std::vector<SandState> states(3, SandState(Slope()));
  HeightfieldConfig config;
  config.threads = 2;
  const auto outcomes = ApplyOnCoarseCells(Heightfield(config), 2, states, paths);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(states[i].map().height_m, Apply(2, Slope(), strokes[i]).height_m);
    const CellRect& changed = outcomes[i].changed;
    EXPECT_GT(outcomes[i].moved_volume_m3, 0);
    for (int row = 0; row < 72; ++row) {
      for (int column = 0; column < 75; ++column) {
        const bool inside = row >= changed.row0 && row < changed.row1 &&
                            column >= changed.column0 && column < changed.column1;
        EXPECT_TRUE(inside || states[i].map().At(row, column) == Slope().At(row, column));
      }
    }
  }
}

}  // namespace
}  // namespace sandwright
