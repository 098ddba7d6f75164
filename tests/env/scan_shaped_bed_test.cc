// The scan on shaped beds whose camera stands somewhere: nothing but the frame is given.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/simulated_beds.h"

namespace sandwright {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

ScanResult Scan(const DepthFrame& frame) { return ScanDepth({&frame, 1}, CameraModel{}, {}); }

class ScanShapedBed : public ::testing::TestWithParam<std::tuple<size_t, bool>> {};

// Each kind and box has a seed of its own; many more are measured in docs/results/scan.json.
TEST_P(ScanShapedBed, IsAcceptedWithItsCornersInPlace) {
  const auto [kind, large_box] = GetParam();
  const SimulatedBed bed = DrawBed(kBedKinds[kind], large_box, kind);
  const ScanResult scan = Scan(bed.frame);
  ASSERT_TRUE(scan.accepted) << scan.reasons.front();
  EXPECT_LT(WorstCorner(bed, scan.corners_C), 0.006);
}

INSTANTIATE_TEST_SUITE_P(Kinds, ScanShapedBed,
                         ::testing::Combine(::testing::Range<size_t>(0, kBedKinds.size()),
                                            ::testing::Bool()));

TEST(ScanScene, RefusesAForearmOverTheSand) {
  for (double above_sand : {0.03, 0.15}) {
    SCOPED_TRACE(above_sand);
    SimulatedBed bed = DrawBed("dunes", true, 1);
    AddForearm(CameraModel{}, bed.X_BC, {0.6, 0.35, 0.1 + above_sand},
               {0.5, -0.2, 0.2 + above_sand}, 0.04, bed.frame);
    EXPECT_FALSE(Scan(bed.frame).accepted);
  }
}

// Depth cannot tell a board from sand that was struck off along a rule, so it is not refused.
TEST(ScanScene, AsksWhetherABoxIsEmpty) {
  RandomStream stream(1);
  const DepthCamera camera(CameraModel{}, CameraAbove(1.2, 0.8, 1.3));
  const ScanResult scan = Scan(camera.Render(HeightMap(160, 240, 0.005, 0.0f), stream));
  EXPECT_TRUE(scan.accepted);
  EXPECT_THAT(scan.warnings, Contains(HasSubstr("is the box empty?")));
}

TEST(ScanScene, RefusesABareTable) {
  RandomStream stream(1);
  DepthCameraConfig bare;
  bare.wall_height_m = 0.001;
  bare.table_m = 0;
  const DepthCamera camera(CameraModel{}, CameraAbove(1.2, 0.8, 1.3), bare);
  EXPECT_FALSE(Scan(camera.Render(HeightMap(160, 240, 0.005, 0.0f), stream)).accepted);
}

}  // namespace
}  // namespace sandwright
