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
  SandState state(map);
  ApplyOnCoarseCells(Heightfield(), factor, state, SamplePath(stroke, 0.002));
  return state.map();
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

TEST(CoarseHeightfield, TellsWhatItChanged) {
  for (const Stroke& stroke : {kStroke, kToTheWall}) {
    SandState state(Slope());
    const Outcome outcome =
        ApplyOnCoarseCells(Heightfield(), 2, state, SamplePath(stroke, 0.002));
    const CellRect& changed = outcome.changed;
    EXPECT_GT(outcome.moved_volume_m3, 0);
    for (int row = 0; row < 72; ++row) {
      for (int column = 0; column < 75; ++column) {
        const bool inside = row >= changed.row0 && row < changed.row1 &&
                            column >= changed.column0 && column < changed.column1;
        EXPECT_TRUE(inside || state.map().At(row, column) == Slope().At(row, column));
      }
    }
  }
}

}  // namespace
}  // namespace sandwright
