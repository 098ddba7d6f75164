// What an operator may do with the blade, and what geometry or symmetry says must come of it.
#include <gtest/gtest.h>

#include <numeric>

#include "env/avalanche.h"
#include "env/heightfield.h"
#include "tests/support/reference_avalanche.h"
#include "tests/support/sand_checks.h"

namespace sandwright {
namespace {

const double kTan = std::tan(33 * std::numbers::pi / 180);

Stroke Polyline(std::vector<Eigen::Vector3d> points) { return {std::move(points), 1, 0.1}; }

HeightMap Apply(const HeightMap& map, const Stroke& stroke, const HeightfieldConfig& config = {}) {
  SandState state(map);
  Heightfield(config).Apply(std::span(&state, 1), std::span(&stroke, 1));
  ExpectSane(map, state.map(), "stroke");
  return state.map();
}

HeightMap Hills(int cells, double cell_m) {
  HeightMap map(cells, cells, cell_m);
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      const double x = (column + 0.5) * cell_m, y = (row + 0.5) * cell_m;
      map.At(row, column) =
          static_cast<float>(0.05 + 0.006 * std::sin(31 * x + 1) * std::cos(23 * y + 9 * x));
    }
  }
  return map;
}

TEST(Operations, CollinearPiecesAreOneStroke) {
  const HeightMap hills = Hills(60, 0.005);
  const Eigen::Vector3d a(0.08, 0.1, 0.035), b(0.22, 0.17, 0.03);
  const HeightMap whole = Apply(hills, Polyline({a, b}));
  const HeightMap pieces = Apply(hills, Polyline({a, a + 0.3 * (b - a), a + 0.55 * (b - a), b}));
  EXPECT_LT(LargestDifference(whole, pieces), 1e-6);
}

TEST(Operations, HalfTheSubstepChangesLittle) {
  const HeightMap hills = Hills(120, 0.0025);
  const Stroke stroke = Polyline({{0.08, 0.1, 0.035}, {0.2, 0.12, 0.03}, {0.18, 0.22, 0.03}});
  HeightfieldConfig half;
  half.substep_cells = 0.5;
  EXPECT_LT(RmsDifference(Apply(hills, stroke), Apply(hills, stroke, half)), 0.3e-3);
}

TEST(Operations, CrossingStrokesDependOnTheirOrder) {
  const HeightMap bed(60, 60, 0.005, 0.05f);
  const Stroke a = Polyline({{0.06, 0.15, 0.03}, {0.24, 0.15, 0.03}});
  const Stroke b = Polyline({{0.15, 0.06, 0.03}, {0.15, 0.24, 0.03}});
  HeightfieldConfig config;
  config.loose_deg = config.repose_deg;  // else rounding decides whether firm sand just starts to flow
  const HeightMap ab = Apply(Apply(bed, a, config), b, config),
                  ba = Apply(Apply(bed, b, config), a, config);
  EXPECT_GT(RmsDifference(ab, ba), 1e-3);
  EXPECT_NEAR(Volume(ab) / Volume(ba), 1, 1e-6);
  // The bed is square and level: one is the other, transposed.
  for (int row = 0; row < 60; ++row) {
    for (int column = 0; column < 60; ++column)
      EXPECT_NEAR(ab.At(row, column), ba.At(column, row), kRounding_m);
  }
}

TEST(Operations, AZeroLengthStrokeAboveTheSandDoesNothing) {
  const HeightMap bed(40, 40, 0.005, 0.05f);
  SandState state(bed);
  const ToolPath stay = {{0.1, 0.1, 0.05, 0.3}, {0.1, 0.1, 0.05, 0.3}};
  const auto outcomes = Heightfield().Apply(std::span(&state, 1), std::span(&stay, 1));
  EXPECT_TRUE(outcomes[0].changed.empty());
  EXPECT_EQ(state.map().height_m, bed.height_m);
}

// A stroke over sand that lies at or below the edge does nothing; without a bite the second stroke
// along the same line meets only what slumped back.
TEST(Operations, RepeatedStrokesDieOut) {
  HeightfieldConfig config;
  config.cut.bite_m = 0;
  HeightMap map(60, 60, 0.005, 0.05f);
  const Stroke stroke = Polyline({{0.08, 0.15, 0.04}, {0.2, 0.15, 0.04}});
  double last = 1;
  for (int k = 0; k < 4; ++k) {
    const HeightMap next = Apply(map, stroke, config);
    const double moved = MovedVolume(map, next, {0, 0, 60, 60});
    EXPECT_LT(moved, last) << k;
    last = moved;
    map = next;
  }
}

// Between walls, without a rupture strip: the sand swept over S metres of depth d meets the wall at a
// gap g from the blade and, when the blade is gone, lies as one heap whose faces are both at repose:
// it falls towards the wall from a crest where the blade stood, and back into the trench.
TEST(Operations, AFullWidthPushAgainstAWall) {
  const double cell_m = 0.0025, bottom_m = 0.03, depth_m = 0.01, start_m = 0.06, end_m = 0.27,
               wall_m = 0.3;
  HeightfieldConfig config;
  config.blade.width_m = 0.05;
  config.cut = {0, 0, 0};
  config.loose_deg = config.repose_deg;
  config.relaxation_m = 1;  // fully fed: the heap is at repose at any time
  const HeightMap bed(20, 120, cell_m, static_cast<float>(bottom_m + depth_m));
  const HeightMap after =
      Apply(bed, Polyline({{start_m, 0.025, bottom_m}, {end_m, 0.025, bottom_m}}), config);
  // The blade's front.
  const double front_m = end_m + config.blade.thickness_m / 2, gap_m = wall_m - front_m;
  const double swept_m2 = (front_m - start_m - config.blade.thickness_m / 2) * depth_m;
  ASSERT_GT(swept_m2, kTan * gap_m * gap_m / 2);  // the heap reaches the wall
  const double at_wall_m = bottom_m + depth_m + swept_m2 / gap_m - kTan * gap_m / 2;
  const auto towards_wall = [&](double x) { return at_wall_m + kTan * (wall_m - x); };
  // The back's toe, from the volume of what lies above the trench between it and the wall.
  const double volume_m2 = swept_m2 + gap_m * depth_m;
  double low = front_m - 0.1, high = front_m + gap_m;
  const auto height = [&](double toe, double x) {
    return bottom_m + std::clamp(kTan * (x - toe), 0.0, towards_wall(x) - bottom_m);
  };
  const auto volume = [&](double toe) {
    double sum = 0;
    for (double x = toe; x < wall_m; x += 1e-5) sum += 1e-5 * (height(toe, x) - bottom_m);
    return sum;
  };
  for (int i = 0; i < 40; ++i)
    (volume((low + high) / 2) > volume_m2 ? low : high) = (low + high) / 2;
  double squared = 0;
  int count = 0;
  for (double x = start_m + 0.02; x < wall_m; x += cell_m, ++count)
    squared += std::pow(HeightAt(after, x, 0.025) - height(low, x), 2);
  EXPECT_LT(std::sqrt(squared / count), 0.3 * cell_m);
}

// The same stroke at other headings, turned back.
TEST(Operations, HeadingDoesNotMatter) {
  const double cell_m = 0.0025, middle_m = 0.2;
  const HeightMap bed(160, 160, cell_m, 0.05f);
  const auto turned = [&](double angle_deg) {
    const double angle = angle_deg * std::numbers::pi / 180;
    const Eigen::Vector3d half(0.06 * std::cos(angle), 0.06 * std::sin(angle), 0),
        middle(middle_m, middle_m, 0.035);
    const HeightMap after = Apply(bed, Polyline({middle - half, middle + half}));
    HeightMap back = bed;
    for (int row = 0; row < 160; ++row) {
      for (int column = 0; column < 160; ++column) {
        const double u = (column + 0.5) * cell_m - middle_m, v = (row + 0.5) * cell_m - middle_m;
        back.At(row, column) =
            static_cast<float>(HeightAt(after, middle_m + u * std::cos(angle) - v * std::sin(angle),
                                        middle_m + u * std::sin(angle) + v * std::cos(angle)));
      }
    }
    return back;
  };
  const HeightMap straight = turned(0);
  for (const double angle_deg : {5.0, 15.0, 30.0, 45.0})
    EXPECT_LT(RmsDifference(straight, turned(angle_deg)), 0.2e-3) << angle_deg;
}

TEST(Operations, FinerCellsConverge) {
  const Stroke stroke = Polyline({{0.1, 0.12, 0.035}, {0.2, 0.17, 0.03}});
  const auto on = [&](double cell_m) {
    const int cells = static_cast<int>(std::lround(0.3 / cell_m));
    return Resample(Apply(HeightMap(cells, cells, cell_m, 0.05f), stroke), 0.01);
  };
  const HeightMap coarse = on(0.01), middle = on(0.005), fine = on(0.0025), finest = on(0.00125);
  const double first = RmsDifference(coarse, middle), second = RmsDifference(middle, fine),
               third = RmsDifference(fine, finest);
  EXPECT_LT(second, 0.7 * first);
  EXPECT_LT(third, 0.7 * second);
}

// Another implementation of the same equations: double precision, plain explicit steps.
TEST(Operations, FloatAndSuperStepsAgreeWithPlainDoubles) {
  HeightMap rough(40, 50, 0.005);
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 50; ++column)
      rough.At(row, column) = static_cast<float>(0.05 + 0.02 * std::sin(0.9 * column) *
                                                            std::cos(0.5 * row + 0.3 * column));
  }
  HeightMap fast = rough;
  RelaxToRepose(fast, 33);
  const HeightMap reference = ReferenceRelax(rough, kTan);
  EXPECT_LT(LargestDifference(fast, reference), 0.05 * rough.cell_size_m);
  EXPECT_LT(RmsDifference(fast, reference), 0.01 * rough.cell_size_m);
}

}  // namespace
}  // namespace sandwright
