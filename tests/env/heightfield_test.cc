#include "env/heightfield.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/support/sand_checks.h"

namespace sandwright {
namespace {

using std::numbers::pi;

HeightMap Bed(int rows = 60, int columns = 60, double cell = 0.005, float height = 0.05f) {
  return HeightMap(rows, columns, cell, height);
}

// Gentle hills without any symmetry.
HeightMap Hills(int rows = 60, int columns = 60, double cell = 0.005) {
  HeightMap map(rows, columns, cell);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double x = (column + 0.5) * cell, y = (row + 0.5) * cell;
      map.At(row, column) =
          static_cast<float>(0.05 + 0.008 * std::sin(31 * x + 1) * std::cos(23 * y + 9 * x));
    }
  }
  return map;
}

Stroke Line(double x0, double y0, double x1, double y1, double z0, double z1) {
  return {{{x0, y0, z0}, {x1, y1, z1}}, 1, 0.1};
}

struct Result {
  HeightMap map;
  Outcome outcome;
};

Result RunStroke(const HeightMap& map, const Stroke& stroke, const HeightfieldConfig& config = {}) {
  std::vector<SandState> states = {SandState(map)};
  const std::vector<Stroke> strokes = {stroke};
  const auto outcomes = Heightfield(config).Apply(states, strokes);
  EXPECT_NEAR(Volume(states[0].map()) / Volume(map), 1, 1e-6);
  EXPECT_GE(*std::ranges::min_element(states[0].map().height_m), 0);
  return {states[0].map(), outcomes[0]};
}

TEST(Heightfield, MovesSandForwardAndLeavesRestingSlopes) {
  const HeightMap before = Bed();
  const auto [after, outcome] = RunStroke(before, Line(0.08, 0.15, 0.20, 0.15, 0.03, 0.03));
  EXPECT_LT(HeightAt(after, 0.13, 0.15), 0.04);    // trench
  EXPECT_GT(HeightAt(after, 0.225, 0.15), 0.055);  // heap
  EXPECT_FALSE(outcome.limited());
  EXPECT_GT(outcome.moved_volume_m3, 5e-5);
  EXPECT_NEAR(outcome.moved_volume_m3, MovedVolume(before, after, {0, 0, 60, 60}), 1e-12);
  EXPECT_LT(SteepestFace(after), std::tan(33 * pi / 180) * 1.0015);
}

TEST(Heightfield, OnlyTheChangedRectangleChanges) {
  const HeightMap before = Hills(120, 160);
  const auto [after, outcome] = RunStroke(before, Line(0.2, 0.2, 0.3, 0.25, 0.035, 0.03));
  ASSERT_FALSE(outcome.changed.empty());
  for (int row = 0; row < 120; ++row) {
    for (int column = 0; column < 160; ++column) {
      const CellRect& r = outcome.changed;
      if (row >= r.row0 && row < r.row1 && column >= r.column0 && column < r.column1) continue;
      EXPECT_EQ(after.At(row, column), before.At(row, column));
    }
  }
}

TEST(Heightfield, AboveTheSurfaceNothingChanges) {
  const HeightMap before = Hills();
  const auto [after, outcome] = RunStroke(before, Line(0.08, 0.08, 0.2, 0.22, 0.06, 0.07));
  EXPECT_EQ(after.height_m, before.height_m);
  EXPECT_TRUE(outcome.changed.empty());
  EXPECT_EQ(outcome.moved_volume_m3, 0);
}

// One pose at the sand's surface, and one below it.
TEST(Heightfield, PlungeAndLiftInPlace) {
  HeightfieldConfig config;
  config.cut.bite_m = 0;
  const Heightfield model(config);
  const HeightMap before = Bed(61, 61);
  std::vector<SandState> states(2, SandState(before));
  const std::vector<ToolPath> paths = {{{0.1525, 0.1525, 0.05, 0}}, {{0.1525, 0.1525, 0.04, 0}}};
  const auto outcomes = model.Apply(states, paths);
  EXPECT_EQ(states[0].map().height_m, before.height_m);
  EXPECT_TRUE(outcomes[0].changed.empty());
  // The blade's own volume below the surface, less what slumps back.
  const double pressed = 0.05 * 0.005 * 0.01;
  EXPECT_GT(outcomes[1].moved_volume_m3, 0.3 * pressed);
  EXPECT_LE(outcomes[1].moved_volume_m3, pressed * (1 + 1e-5));
  const HeightMap& after = states[1].map();
  for (int row = 0; row < 61; ++row) {
    for (int column = 0; column < 61; ++column)
      EXPECT_NEAR(after.At(row, column), after.At(row, 60 - column), 1e-7);
  }
}

// Between walls there is no way around the blade: the floor behind it lies exactly at its edge, and
// nothing leaks back through it.
TEST(Heightfield, ABladeAsWideAsTheBoxLeavesAFloorAtItsEdge) {
  HeightfieldConfig config;
  config.blade.width_m = 0.2;
  config.cut.bite_m = 0;
  config.loose_deg = config.repose_deg;
  for (const double cell : {0.01, 0.005, 0.0025}) {
    const int rows = static_cast<int>(std::lround(0.2 / cell));
    const HeightMap after =
        RunStroke(Bed(rows, 2 * rows, cell), Line(0.08, 0.1, 0.3, 0.1, 0.035, 0.035), config).map;
    for (double x = 0.11; x < 0.22; x += cell) {
      for (double y = cell / 2; y < 0.2; y += cell)
        EXPECT_NEAR(HeightAt(after, x, y), 0.035, 1e-5) << cell << " " << x;
    }
  }
}

// A clean cut of depth d, width w slumps to a trench with a floor of w - d / t and a top of w + d / t.
TEST(Heightfield, ACleanCutSlumpsToItsTrench) {
  HeightfieldConfig config;
  config.cut = {4, 0, 0};
  config.relaxation_m = 0;  // no side-cast while the blade moves
  const HeightMap after =
      RunStroke(Bed(160, 240, 0.0025), Line(0.1, 0.2, 0.4, 0.2, 0.04, 0.04), config).map;
  const double t = std::tan(33 * pi / 180), depth = 0.01;
  for (double y = -0.05; y <= 0.05; y += 0.0025) {
    const double expected = 0.04 + std::clamp(depth / 2 + (std::abs(y) - 0.025) * t, 0.0, depth);
    EXPECT_NEAR(HeightAt(after, 0.25, 0.2 + y), expected, 0.0008) << y;
  }
}

TEST(Heightfield, MirroredAndTransposedStrokesGiveMirroredSand) {
  const HeightMap map = Hills(56, 64);
  const double width = map.width_m();
  const Stroke stroke{{{0.08, 0.07, 0.035}, {0.17, 0.11, 0.03}, {0.2, 0.2, 0.04}}, 1, 0.1};
  HeightMap mirrored = map, transposed(64, 56, map.cell_size_m);
  Stroke mirrored_stroke = stroke, transposed_stroke = stroke;
  for (int row = 0; row < 56; ++row) {
    for (int column = 0; column < 64; ++column) {
      mirrored.At(row, 63 - column) = map.At(row, column);
      transposed.At(column, row) = map.At(row, column);
    }
  }
  for (auto& p : mirrored_stroke.control_points_m) p.x() = width - p.x();
  for (auto& p : transposed_stroke.control_points_m) std::swap(p.x(), p.y());
  const HeightMap a = RunStroke(map, stroke).map, b = RunStroke(mirrored, mirrored_stroke).map,
                  c = RunStroke(transposed, transposed_stroke).map;
  for (int row = 0; row < 56; ++row) {
    for (int column = 0; column < 64; ++column) {
      EXPECT_NEAR(a.At(row, column), b.At(row, 63 - column), kRounding_m);
      EXPECT_NEAR(a.At(row, column), c.At(column, row), kRounding_m);
    }
  }
}

TEST(Heightfield, DoesNotDependOnHowThePathWasSampled) {
  const Heightfield model;
  std::vector<SandState> states(2, SandState(Hills()));
  const Stroke stroke{{{0.08, 0.1, 0.035}, {0.16, 0.1, 0.03}, {0.2, 0.2, 0.04}}, 1, 0.1};
  const std::vector<ToolPath> paths = {SamplePath(stroke, 0.0005, 0.01),
                                       SamplePath(stroke, 0.004, 0.1)};
  model.Apply(states, paths);
  EXPECT_LT(LargestDifference(states[0].map(), states[1].map()), 1e-6);
}

TEST(Heightfield, RepeatingAStrokeMovesLess) {
  const Stroke stroke = Line(0.08, 0.15, 0.2, 0.15, 0.035, 0.035);
  const Result first = RunStroke(Bed(), stroke), second = RunStroke(first.map, stroke);
  EXPECT_LT(second.outcome.moved_volume_m3, 0.6 * first.outcome.moved_volume_m3);
}

TEST(Heightfield, PushingAgainstAWallLosesNothing) {
  const auto [after, outcome] = RunStroke(Bed(), Line(0.2, 0.15, 0.298, 0.15, 0.02, 0.02));
  EXPECT_FALSE(outcome.left_box);
  EXPECT_GT(after.At(30, 59), 0.055);
}

TEST(Heightfield, ReportsWhatLeavesTheBoxOrGoesBelowTheFloor) {
  const Result out = RunStroke(Bed(), Line(0.2, 0.15, 0.33, 0.15, 0.03, 0.03));
  EXPECT_TRUE(out.outcome.left_box);
  EXPECT_FALSE(out.outcome.below_floor);
  const Result along_wall = RunStroke(Bed(), Line(0.1, 0.02, 0.2, 0.02, 0.03, 0.03));
  EXPECT_TRUE(along_wall.outcome.left_box);  // half the blade is outside
  const Result deep = RunStroke(Bed(), Line(0.1, 0.15, 0.2, 0.15, 0.02, -0.02));
  EXPECT_TRUE(deep.outcome.below_floor);
  EXPECT_FALSE(deep.outcome.left_box);
  // Where the floor is not known, heights may be below zero and nothing is clipped.
  HeightMap relative = Bed(60, 60, 0.005, 0);
  relative.datum = Datum::kRelative;
  std::vector<SandState> states = {SandState(relative)};
  const std::vector<Stroke> strokes = {Line(0.1, 0.15, 0.2, 0.15, -0.015, -0.015)};
  EXPECT_FALSE(Heightfield().Apply(states, strokes)[0].below_floor);
  EXPECT_LT(HeightAt(states[0].map(), 0.14, 0.15), -0.01);
}

TEST(Heightfield, WorksOnAnyGrid) {
  const Stroke stroke = Line(0.08, 0.12, 0.2, 0.15, 0.03, 0.03);
  const HeightMap fine = RunStroke(Bed(120, 120, 0.0025), stroke).map;
  for (const double cell : {0.005, 0.01}) {
    const int count = static_cast<int>(std::lround(0.3 / cell));
    const HeightMap coarse = RunStroke(Bed(count, count, cell), stroke).map,
                    reference = Resample(fine, cell);
    double sum = 0;
    for (size_t i = 0; i < coarse.size(); ++i)
      sum += std::pow(coarse.height_m[i] - reference.height_m[i], 2);
    // First order in the cell: the blade is 5 cells wide at 10 mm.
    EXPECT_LT(std::sqrt(sum / static_cast<double>(coarse.size())), 0.2 * cell) << cell;
  }
  RunStroke(Bed(2, 40, 0.01), Line(0.1, 0.01, 0.2, 0.01, 0.03, 0.03));
  RunStroke(Bed(40, 2, 0.01), Line(0.01, 0.1, 0.01, 0.2, 0.03, 0.03));
  RunStroke(Bed(6, 6, 0.05), Line(0.1, 0.15, 0.2, 0.15, 0.03, 0.03));
}

TEST(Heightfield, SameBytesForAnyThreadCountAndBatchOrder) {
  std::vector<Stroke> strokes;
  for (int i = 0; i < 8; ++i)
    strokes.push_back(Line(0.1 + 0.01 * i, 0.1, 0.2, 0.2 - 0.01 * i, 0.03, 0.04));
  HeightfieldConfig config;
  std::vector<SandState> one(8, SandState(Hills())), four = one, reversed = one;
  Heightfield(config).Apply(one, strokes);
  config.threads = 4;
  Heightfield(config).Apply(four, strokes);
  const std::vector<Stroke> backwards(strokes.rbegin(), strokes.rend());
  Heightfield(config).Apply(reversed, backwards);
  for (size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(one[i].map().height_m, four[i].map().height_m);
    EXPECT_EQ(one[i].map().height_m, reversed[7 - i].map().height_m);
  }
}

TEST(Heightfield, BadInputThrowsBeforeAnythingChanges) {
  const Heightfield model;
  const HeightMap good = Bed();
  HeightMap bad = good;
  bad.At(3, 4) = std::numeric_limits<float>::quiet_NaN();
  const auto expect_error = [&](const HeightMap& second, const ToolPath& path,
                                const std::string& message) {
    std::vector<SandState> states = {SandState(good), SandState(second)};
    const std::vector<ToolPath> paths = {SamplePath(Line(0.1, 0.1, 0.2, 0.1, 0.03, 0.03), 0.002),
                                         path};
    try {
      model.Apply(states, paths);
      FAIL() << message;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(message), std::string::npos) << e.what();
    }
    EXPECT_EQ(states[0].map().height_m, good.height_m);
  };
  expect_error(bad, {{0.1, 0.1, 0.03, 0}}, "row 3, column 4 is nan");
  expect_error(HeightMap(1, 1, 0.005, 0.05f), {{0.1, 0.1, 0.03, 0}}, "at least 1 x 2");
  expect_error(good, {}, "tool path 1 is empty");
  expect_error(good, {{0.1, std::nan(""), 0.03, 0}}, "not finite");
  HeightfieldConfig config;
  config.repose_deg = 75;
  EXPECT_THROW(Heightfield{config}, Error);
}

}  // namespace
}  // namespace sandwright
