// Hard cases: what breaks sand models. Every bed must stay finite, above the floor, of the same volume,
// and come to rest.
#include <gtest/gtest.h>

#include <functional>

#include "data/excavation.h"
#include "env/avalanche.h"
#include "env/heightfield.h"
#include "env/terrain_generator.h"
#include "tests/support/sand_checks.h"

namespace sandwright {
namespace {

const double kTan = std::tan(33 * std::numbers::pi / 180);
constexpr double kAtRest = 1.0065;  // untouched sand holds 0.5 % more; the tolerance is 0.1 %

HeightMap Make(int rows, int columns, double cell_m,
               const std::function<double(int, int)>& height_m) {
  HeightMap map(rows, columns, cell_m);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column)
      map.At(row, column) = static_cast<float>(height_m(row, column));
  }
  return map;
}

Stroke Line(double x0, double y0, double x1, double y1, double z0, double z1) {
  return {{{x0, y0, z0}, {x1, y1, z1}}, 1, 0.1};
}

HeightMap Apply(const HeightMap& map, const Stroke& stroke, const HeightfieldConfig& config = {}) {
  SandState state(map);
  Heightfield(config).Apply(std::span(&state, 1), std::span(&stroke, 1));
  return state.map();
}

// Wild terrains on cells of `cell_m`: a spike, a cliff at a wall, one-cell ridges, a lone wall of sand.
std::vector<std::pair<std::string, HeightMap>> WildTerrains(double cell_m, int rows, int columns) {
  const auto make = [&](const std::function<double(int, int)>& height_m) {
    return Make(rows, columns, cell_m, height_m);
  };
  return {{"spike",
           make([&](int r, int c) { return r == rows / 2 && c == columns / 2 ? 0.13 : 0.03; })},
          {"spike on the floor",
           make([&](int r, int c) { return r == rows / 2 && c == columns / 2 ? 0.1 : 0; })},
          {"cliff at a wall", make([&](int, int c) { return c < 2 ? 0.12 : 0.02; })},
          {"corner column", make([&](int r, int c) { return r == 0 && c == 0 ? 0.2 : 0.02; })},
          {"ridges", make([&](int, int c) { return c % 4 == 0 ? 0.06 : 0.02; })},
          {"checkerboard", make([&](int r, int c) { return (r + c) % 2 ? 0.08 : 0.0; })}};
}

TEST(HeightfieldStability, WildTerrainsComeToRestOnAnyGrid) {
  for (const double cell_m : {0.001, 0.0025, 0.005, 0.01, 0.02}) {
    for (const auto& [name, terrain] : WildTerrains(cell_m, 24, 30)) {
      const std::string what = name + " at " + std::to_string(cell_m);
      HeightMap map = terrain;
      RelaxToRepose(map, 33);
      ExpectSane(terrain, map, what);
      EXPECT_LT(SteepestFace(map), kTan * kAtRest) << what;
    }
  }
}

TEST(HeightfieldStability, StrokesThroughWildTerrains) {
  for (const double substep_cells : {0.05, 0.5, 1.0}) {
    HeightfieldConfig config;
    config.substep_cells = substep_cells;
    for (const auto& [name, terrain] : WildTerrains(0.005, 40, 50)) {
      for (const Stroke& stroke :
           {Line(0.03, 0.1, 0.22, 0.1, 0, 0), Line(0.2, 0.02, 0.05, 0.18, 0.01, 0.06),
            Line(-0.1, 0.1, 0.35, 0.1, 0.02, -0.05)})
        ExpectSane(terrain, Apply(terrain, stroke, config), name);
    }
  }
}

TEST(HeightfieldStability, ABladeThroughACliff) {
  const HeightMap cliff =
      Make(60, 60, 0.005, [](int, int column) { return column < 30 ? 0.02 : 0.12; });
  const HeightMap after = Apply(cliff, Line(0.05, 0.15, 0.25, 0.15, 0.01, 0.01));
  ExpectSane(cliff, after, "cliff");
  EXPECT_LT(*std::ranges::max_element(after.height_m), 0.2);
}

TEST(HeightfieldStability, DeepCutsReachTheFloorAndNoFurther) {
  const HeightMap bed(60, 60, 0.005, 0.04f);
  HeightfieldConfig config;
  config.loose_deg = config.repose_deg;
  const HeightMap after = Apply(bed, Line(0.08, 0.15, 0.22, 0.15, 0, 0), config);
  ExpectSane(bed, after, "to the floor");
  EXPECT_LT(HeightAt(after, 0.15, 0.15),
            0.017);  // the flanks slump into a cut that is deeper than wide
  EXPECT_LT(SteepestFace(after), kTan * kAtRest);
}

TEST(HeightfieldStability, NarrowAndSmallMaps) {
  for (const auto& [rows, columns] :
       {std::pair(1, 60), {60, 1}, {1, 2}, {2, 1}, {2, 2}, {3, 200}}) {
    const HeightMap bed =
        Make(rows, columns, 0.005, [](int r, int c) { return 0.03 + 0.02 * ((r + c) % 3); });
    const double x = bed.width_m(), y = bed.depth_m();
    const std::string what = std::to_string(rows) + " x " + std::to_string(columns);
    ExpectSane(bed, Apply(bed, Line(0.1 * x, 0.1 * y, 0.9 * x + 0.002, 0.9 * y, 0.01, 0.02)), what);
    HeightMap map = bed;
    RelaxToRepose(map, 33);
    EXPECT_LT(SteepestFace(map), kTan * kAtRest) << what;
  }
}

TEST(HeightfieldStability, AWholeBoxOnMillimetreCells) {
  const HeightMap box(800, 1200, 0.001, 0.05f);
  const HeightMap after = Apply(box, Line(0.55, 0.4, 0.62, 0.42, 0.035, 0.035));
  ExpectSane(box, after, "1200 x 800 mm at 1 mm");
  EXPECT_LT(HeightAt(after, 0.58, 0.405), 0.045);
}

TEST(HeightfieldStability, RandomStrokesNeverBreakABed) {
  const auto run = [](int threads) { return RunRandomStrokes({}, 1600, 7, threads, [](auto&) {}); };
  const RandomStrokeTally tally = run(2);
  EXPECT_TRUE(tally.sound()) << tally.ToJson().dump(1);
  EXPECT_EQ(tally.strokes, 1600);
  EXPECT_GT(tally.limited, 100);
}

}  // namespace
}  // namespace sandwright
