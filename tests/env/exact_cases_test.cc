// The heightfield's avalanche against closed forms (env/exact_cases.h), errors in cells.
#include "env/exact_cases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace sandwright {
namespace {

constexpr double kRepose_deg = 33;

double Volume(const HeightMap& map) {
  return std::accumulate(map.height_m.begin(), map.height_m.end(), 0.0);
}

// What the scheme reaches, and a little: the tolerance at rest lets slopes be steeper by a thousandth.
TEST(ExactCases, EachEndsAsItsFormulaSays) {
  struct Limit {
    double rmse, largest, volume;
  };
  const Limit usual{0.012, 0.1, 1e-5}, portions{0.18, 0.9, 1e-5};
  int found = 0;
  for (const ExactCase& exact : ExactCases(kRepose_deg, 1e-3)) {
    const HeightMap map = SettleCase(exact, kRepose_deg);
    const CellError error = Differ(map, exact.expected);
    const Limit limit = exact.name == "two sources" ? portions : usual;
    EXPECT_LT(error.rmse, limit.rmse) << exact.name;
    EXPECT_LT(error.largest, limit.largest) << exact.name;
    EXPECT_NEAR(Volume(map) / Volume(exact.start), 1, limit.volume) << exact.name;
    // The formula is one of the same sand.
    EXPECT_NEAR(Volume(exact.expected) / Volume(exact.start), 1, 2e-3) << exact.name;
    const bool at_rest = exact.start.height_m == exact.expected.height_m;
    EXPECT_EQ(map.height_m == exact.start.height_m, at_rest) << exact.name;
    ++found;
  }
  EXPECT_EQ(found, 26);
}

TEST(ExactCases, AngleAndCellSizeOnlyScale) {
  for (const double repose_deg : {25.0, 45.0}) {
    for (const ExactCase& exact : ExactCases(repose_deg, 0.02)) {
      if (exact.name != "cylinder to frustum" && exact.name != "trench, narrow") continue;
      EXPECT_LT(Differ(SettleCase(exact, repose_deg), exact.expected).rmse, 0.012) << exact.name;
    }
  }
}

TEST(ExactCases, PilesAreRound) {
  const ExactCase pour = ExactCases(kRepose_deg, 1e-3).front();
  EXPECT_LT(ContourSpread(SettleCase(pour, kRepose_deg)), 0.005);
}

TEST(ExactCases, TheMeasureOfRoundnessSeesADiamond) {
  HeightMap diamond(101, 101, 1e-3);
  for (int row = 0; row < 101; ++row) {
    for (int column = 0; column < 101; ++column)
      diamond.At(row, column) =
          static_cast<float>(std::max(0, 40 - std::abs(row - 50) - std::abs(column - 50)));
  }
  EXPECT_NEAR(ContourSpread(diamond), 1 - std::sqrt(0.5), 0.1);
}

}  // namespace
}  // namespace sandwright
