#include "env/depth_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "data/scan.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;

// Gentle dunes, slopes up to 29 degrees.
HeightMap Dunes() {
  HeightMap bed(160, 240, 0.005);
  const double turn = 2 * std::numbers::pi;
  for (int j = 0; j < bed.rows; ++j) {
    for (int i = 0; i < bed.columns; ++i) {
      const double x = (i + 0.5) * 0.005, y = (j + 0.5) * 0.005;
      bed.At(j, i) =
          static_cast<float>(0.06 + 0.015 * std::sin(turn * x / 0.4) * std::cos(turn * y / 0.3) +
                             0.008 * std::sin(turn * (x + y) / 0.17));
    }
  }
  return bed;
}

DepthCameraConfig Perfect() {
  DepthCameraConfig config;
  config.noise_m = config.dropout_share = config.edge_dropout_share = config.wall_dropout_share = 0;
  return config;
}

double Rmse(const HeightMap& a, const HeightMap& b) {
  double squares = 0;
  for (size_t i = 0; i < a.size(); ++i) squares += std::pow(a.height_m[i] - b.height_m[i], 2);
  return std::sqrt(squares / static_cast<double>(a.size()));
}

TEST(DepthCamera, SeesFlatSandWallsAndTableWhereTheyAre) {
  const HeightMap bed(160, 240, 0.005, 0.05f);
  const DepthCamera camera(CameraModel{}, CameraAbove(1.2, 0.8, 1.35), Perfect());
  RandomStream stream(1);
  const DepthFrame frame = camera.Render(bed, stream);
  EXPECT_FLOAT_EQ(frame.At(256, 212), 1.3f);
  // x = 0.595: still sand. At 0.603 the rim (0.15 m up) is hit, at 0.8 the table.
  EXPECT_FLOAT_EQ(frame.At(256 + static_cast<int>(366 * 0.595 / 1.3), 212), 1.3f);
  EXPECT_FLOAT_EQ(frame.At(256 + static_cast<int>(366 * 0.609 / 1.2), 212), 1.2f);
  EXPECT_NEAR(frame.At(256 + static_cast<int>(366 * 0.9 / 1.368), 212), 1.368, 1e-6);
  // A pixel that looks at the wall's face: z = 0.6 f / (u - cx).
  EXPECT_NEAR(frame.At(256 + 176, 212), 0.6 * 366 / 176, 0.0006);
}

TEST(DepthCamera, FindsSlopesToTheResolution) {
  HeightMap bed(160, 240, 0.005);
  for (int j = 0; j < bed.rows; ++j)
    for (int i = 0; i < bed.columns; ++i)
      bed.At(j, i) = static_cast<float>(0.1 * (i + 0.5) * 0.005);
  const DepthCamera camera(CameraModel{}, CameraAbove(1.2, 0.8, 1.35), Perfect());
  RandomStream stream(1);
  const DepthFrame frame = camera.Render(bed, stream);
  for (int u = 110; u < 400; u += 7) {
    const double ray = (u - 256) / 366.0;  // 1.35 - z = 0.1 (0.6 + ray z)
    EXPECT_NEAR(frame.At(u, 212), (1.35 - 0.06) / (1 + 0.1 * ray), 0.0006) << u;
  }
}

TEST(DepthCamera, NoiseGrowsWithTheSquareOfDepth) {
  for (double height : {1.2, 2.4}) {
    DepthCameraConfig config = Perfect();
    config.noise_m = 0.0006;
    config.resolution_m = 0.0001;
    const DepthCamera camera(CameraModel{}, CameraAbove(1.2, 0.8, height), config);
    RandomStream stream(3);
    const DepthFrame frame = camera.Render(HeightMap(160, 240, 0.005, 0), stream);
    double squares = 0;
    int count = 0;
    for (int v = 180; v < 240; ++v)
      for (int u = 190; u < 320; ++u, ++count) squares += std::pow(frame.At(u, v) - height, 2);
    EXPECT_NEAR(std::sqrt(squares / count), 0.0006 * std::pow(height / 1.2, 2), 0.00002);
  }
}

TEST(DepthCamera, SameStreamSameFrameAndTheNextDiffers) {
  const HeightMap bed = Dunes();
  const DepthCamera camera(CameraModel{}, CameraAbove(1.2, 0.8, 1.35));
  RandomStream a(7), b(7);
  const DepthFrame first = camera.Render(bed, a);
  EXPECT_EQ(first.depth_m, camera.Render(bed, b).depth_m);
  EXPECT_NE(first.depth_m, camera.Render(bed, a).depth_m);
}

TEST(DepthCamera, RefusesACameraBelowTheRim) {
  const DepthCamera camera(CameraModel{}, CameraAbove(1.2, 0.8, 0.1));
  RandomStream stream(1);
  EXPECT_THAT(
      [&] { camera.Render(Dunes(), stream); },
      ::testing::Throws<Error>(::testing::Property(&Error::what, HasSubstr("0.100 m above"))));
}

// Terrain -> frame -> scan -> height map. Measured: 0.36 mm by pose, 0.36 by the rim, 0.45 by the
// sand's plane (which the dunes turn by 0.04 degrees).
TEST(DepthCamera, ScanBringsTheTerrainBack) {
  const HeightMap bed = Dunes();
  const Eigen::Isometry3d X_BC = CameraAbove(1.2, 0.8, 1.35);
  RandomStream stream(1);
  const DepthFrame frame = DepthCamera(CameraModel{}, X_BC).Render(bed, stream);
  const Eigen::Vector2d size_m(1.2, 0.8);
  ScanConfig config;
  for (const auto& [level, place] : {std::pair{"none", ScanPlace{size_m, X_BC, std::nullopt}},
                                     {"rim", ScanPlace{size_m, std::nullopt, 0.06}},
                                     {"sand", ScanPlace{size_m, std::nullopt, 0.06}}}) {
    config.level = level;
    const ScanResult scan = ScanDepth({&frame, 1}, CameraModel{}, config, place);
    ASSERT_TRUE(scan.accepted) << scan.reasons.front();
    EXPECT_EQ(scan.map.datum, Datum::kFloor);
    ASSERT_TRUE(scan.map.SameGrid(bed));
    EXPECT_LT(Rmse(scan.map, bed), 0.0006) << level;
  }
}

TEST(DepthCamera, ScanTakesOutTheCamerasTilt) {
  const HeightMap bed = Dunes();
  Eigen::Isometry3d X_BC = CameraAbove(1.2, 0.8, 1.35);
  X_BC.linear() = X_BC.linear() * Eigen::AngleAxisd(0.06, Eigen::Vector3d(1, 0.5, 0).normalized()) *
                  Eigen::AngleAxisd(0.09, Eigen::Vector3d::UnitZ());
  RandomStream stream(2);
  const DepthFrame frame = DepthCamera(CameraModel{}, X_BC).Render(bed, stream);
  ScanConfig config;
  config.level = "rim";
  const ScanResult scan = ScanDepth({&frame, 1}, CameraModel{}, config,
                                    {Eigen::Vector2d(1.2, 0.8), std::nullopt, 0.06});
  ASSERT_TRUE(scan.accepted) << scan.reasons.front();
  EXPECT_NEAR(scan.tilt_removed_deg, 0.06 * 180 / std::numbers::pi, 0.1);
  EXPECT_LT(Rmse(scan.map, bed), 0.0008);
}

TEST(DepthCamera, ScanChecksThePoseByTheWalls) {
  const HeightMap bed = Dunes();
  Eigen::Isometry3d X_BC = CameraAbove(1.2, 0.8, 1.35);
  RandomStream stream(1);
  const DepthFrame frame = DepthCamera(CameraModel{}, X_BC).Render(bed, stream);
  ScanPlace place{Eigen::Vector2d(1.2, 0.8), X_BC, std::nullopt};
  EXPECT_LT(ScanDepth({&frame, 1}, CameraModel{}, {}, place).registration_error_m.value(), 0.004);
  place.X_BC->translation().x() += 0.03;  // the box was moved
  const ScanResult moved = ScanDepth({&frame, 1}, CameraModel{}, {}, place);
  EXPECT_FALSE(moved.accepted);
  EXPECT_THAT(moved.reasons, ::testing::Contains(HasSubstr("at most 20 mm")));
}

}  // namespace
}  // namespace sandwright
