#include "env/grains.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace sandwright {
namespace {

TEST(Grains, TheSurfaceIsTheTopOfTheHighestSphere) {
  const GrainBed bed{0.05, 0.03, {{0.025, 0.015, 0.010, 0.006}, {0.025, 0.015, 0.002, 0.007}}};
  const HeightMap map = SurfaceOf(bed, 3, 5, 0);
  EXPECT_FLOAT_EQ(map.At(1, 2), 0.016f);
  EXPECT_EQ(std::ranges::count(map.height_m, 0.0f), 14);  // the floor: no other centre is covered
  const HeightMap fine = SurfaceOf(bed, 30, 50, 0);
  EXPECT_EQ(fine.cell_size_m, 0.001);
  // 2.5 and 0.5 mm off the middle.
  EXPECT_NEAR(fine.At(15, 27), 0.010 + std::sqrt(36e-6 - 6.25e-6 - 0.25e-6), 1e-8);
}

TEST(Grains, BlurKeepsALevelSurface) {
  GrainBed bed{0.04, 0.04, {}};
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j)
      bed.grains.push_back({0.0005 + 0.001 * i, 0.0005 + 0.001 * j, 0.02, 0.001});
  }
  for (const float h : SurfaceOf(bed, 20, 20, 0.004).height_m) EXPECT_NEAR(h, 0.021, 3e-4);
}

}  // namespace
}  // namespace sandwright
