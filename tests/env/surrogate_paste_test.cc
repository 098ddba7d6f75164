#include "env/surrogate_paste.h"

#include <gtest/gtest.h>

#include <numeric>

namespace sandwright {
namespace {

TEST(SurrogatePaste, ResidualRules) {
  const CellRect rect{0, 0, 2, 2};
  HeightMap map(2, 2, 0.004, 0.01f);
  AddResidual(rect, {0.002, 0.004, -0.02, -0.002}, false, map);  // -0.02 finds only 0.01
  EXPECT_NEAR(map.At(0, 1), 0.014, 1e-7);
  EXPECT_EQ(map.At(1, 0), 0);
  HeightMap same(2, 2, 0.004, 0.01f);
  AddResidual(rect, {0.002, 0.004, -0.02, -0.002}, true, same);  // 12 out, 6 in: half goes out
  EXPECT_NEAR(same.At(1, 0), 0.005, 1e-7);
  EXPECT_NEAR(same.At(1, 1), 0.009, 1e-7);
  EXPECT_NEAR(same.At(0, 1), 0.014, 1e-7);
  HeightMap relative(2, 2, 0.004, 0.01f, Datum::kRelative);
  AddResidual(rect, {0, 0, -0.02, 0}, false, relative);
  EXPECT_NEAR(relative.At(1, 0), -0.01, 1e-7);
}

// By hand: 4 mm from the left column to the right, of which the lower left cell can give only 1 mm.
TEST(SurrogatePaste, FluxesMoveSandAndADonorGivesWhatItHas) {
  HeightMap map(2, 2, 0.004, 0.010f);
  map.At(1, 0) = 0.001f;
  // To the next column: rows 0 and 1; to the next row: 0. Faces at the edge are closed.
  AddFluxes({0, 0, 2, 2}, std::vector<double>{0.004, 9, 0.004, 9, 0, 0, 9, 9}, map);
  EXPECT_NEAR(map.At(0, 0), 0.006, 1e-7);
  EXPECT_NEAR(map.At(0, 1), 0.014, 1e-7);
  EXPECT_EQ(map.At(1, 0), 0);
  EXPECT_NEAR(map.At(1, 1), 0.011, 1e-7);
}

TEST(SurrogatePaste, ADonorSharesAmongItsNeighboursAndFluxesMayRunBack) {
  HeightMap map(1, 3, 0.004, 0.003f);
  map.At(0, 1) = 0.006f;
  // The middle cell gives 8 mm to the left and 4 mm to the right, but holds 6: half of each.
  AddFluxes({0, 0, 1, 3}, std::vector<double>{-0.008, 0.004, 0, 0, 0, 0}, map);
  EXPECT_NEAR(map.At(0, 0), 0.007, 1e-7);
  EXPECT_EQ(map.At(0, 1), 0);
  EXPECT_NEAR(map.At(0, 2), 0.005, 1e-7);
  // Without a floor nothing is limited.
  HeightMap relative(1, 3, 0.004, 0.003f, Datum::kRelative);
  AddFluxes({0, 0, 1, 3}, std::vector<double>{-0.008, 0.004, 0, 0, 0, 0}, relative);
  EXPECT_NEAR(relative.At(0, 1), -0.009, 1e-7);
}

}  // namespace
}  // namespace sandwright
