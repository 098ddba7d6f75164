// The scan on real frames of a Kinect v2 and on what becomes of them when the camera stands elsewhere.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "data/base/random.h"
#include "data/scan.h"
#include "tests/support/shared_data.h"
#include "tests/support/tag_corners.h"

namespace sandwright {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

const CameraModel kKinect;

// Changes of the frame: where each pixel of the new picture looks in the old one.
DepthFrame Warped(const DepthFrame& frame, const cv::Matx23f& new_from_old,
                  double depth_factor = 1) {
  const cv::Mat image(frame.height, frame.width, CV_32F, const_cast<float*>(frame.depth_m.data()));
  cv::Mat warped;
  cv::warpAffine(image, warped, new_from_old, image.size(), cv::INTER_NEAREST);
  warped *= depth_factor;
  return {frame.width, frame.height, {warped.begin<float>(), warped.end<float>()}};
}

// The frame as a camera would see it that moved by X_NC (new from old): points reprojected, the nearest wins.
DepthFrame Reprojected(const DepthFrame& frame, const Eigen::Isometry3d& X_NC) {
  DepthFrame out{frame.width, frame.height, std::vector<float>(frame.depth_m.size(), 0)};
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      const double z = frame.At(u, v);
      if (!(z > 0)) continue;
      const Eigen::Vector3d p = X_NC * Eigen::Vector3d((u - 256) * z / 366, (v - 212) * z / 366, z);
      const long a = std::lround(366 * p.x() / p.z() + 256),
                 b = std::lround(366 * p.y() / p.z() + 212);
      if (a < 0 || b < 0 || a >= frame.width || b >= frame.height) continue;
      float& seen = out.depth_m[static_cast<size_t>(b * frame.width + a)];
      if (seen == 0 || p.z() < seen) seen = static_cast<float>(p.z());
    }
  }
  return out;
}

// A turn about the middle of the sand, 1.26 m below the camera.
Eigen::Isometry3d TurnedAboutSand(double x_deg, double y_deg) {
  const Eigen::Translation3d middle(0.06, 0.09, 1.26);
  return Eigen::Isometry3d(
      middle * Eigen::AngleAxisd(x_deg * M_PI / 180, Eigen::Vector3d::UnitX()) *
      Eigen::AngleAxisd(y_deg * M_PI / 180, Eigen::Vector3d::UnitY()) * middle.inverse());
}

class ScanReal : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto file = SharedFile("data/scans/kinect2_depth_levelled_box.npy");
    if (!std::filesystem::exists(file)) GTEST_SKIP() << "no " << file;
    frame_ = ReadDepthFrame(file);
  }
  // Accepted, with a box of the real size: 1030 x 825 mm by the infrared picture, to 15 mm.
  ScanResult Accepted(const DepthFrame& frame, double scale = 1) {
    ScanResult scan = ScanDepth({&frame, 1}, kKinect, {});
    EXPECT_TRUE(scan.accepted) << scan.reasons.front();
    EXPECT_TRUE(scan.warnings.empty()) << scan.warnings.front();
    EXPECT_NEAR(scan.map.width_m(), 1.030 * scale, 0.015);
    EXPECT_NEAR(scan.map.depth_m(), 0.825 * scale, 0.015);
    return scan;
  }
  DepthFrame frame_;
};

TEST_F(ScanReal, CornersLieWhereTheTagsShowThem) {
  const auto feet = TagCorners();
  const ScanResult scan = Accepted(frame_);
  for (size_t i = 0; i < 4; ++i)
    EXPECT_LT((scan.corners_C[i].head<2>() - feet[i]).norm(), 0.010) << i;  // 9.4, 2.6, 5.1, 4.8 mm
}

TEST_F(ScanReal, MapHoldsTheSandAlone) {
  const ScanResult scan = Accepted(frame_);
  EXPECT_EQ(scan.map.datum, Datum::kRelative);  // nothing says where the floor is
  EXPECT_NEAR(scan.tilt_removed_deg, 2.9, 0.3);
  EXPECT_NEAR(scan.noise_mm, 0.585, 0.03);
  EXPECT_LT(scan.invalid_share, 0.001);
  EXPECT_LT(scan.interpolated_share, 0.01);
  // Raked level by hand: no wall, no tag, no floor in it.
  double squares = 0;
  for (float h : scan.map.height_m) squares += h * h;
  EXPECT_LT(std::sqrt(squares / static_cast<double>(scan.map.size())), 0.008);
  const auto [low, high] = std::ranges::minmax(scan.map.height_m);
  EXPECT_LT(high - low, 0.08);
}

TEST_F(ScanReal, PassesShifted) {
  for (const auto& [du, dv] :
       {std::pair{40, 0}, {-30, 25}, {0, -40}, {0, 35}, {-60, 0}, {-60, 30}}) {
    SCOPED_TRACE(::testing::Message() << du << ", " << dv);
    Accepted(Warped(frame_, {1, 0, static_cast<float>(du), 0, 1, static_cast<float>(dv)}));
  }
}

TEST_F(ScanReal, PassesTurnedInThePicture) {
  for (double degrees : {10.0, -10.0, 45.0, 90.0}) {
    SCOPED_TRACE(degrees);
    const auto c = static_cast<float>(std::cos(degrees * M_PI / 180)),
               s = static_cast<float>(std::sin(degrees * M_PI / 180));
    Accepted(Warped(frame_, {c, s, 256 - c * 256 - s * 212, -s, c, 212 + s * 256 - c * 212}));
  }
}

TEST_F(ScanReal, PassesTilted) {
  for (const auto& [x_deg, y_deg] : {std::pair{5, 0}, {-5, 0}, {0, 5}, {0, -5}, {-8, 0}, {0, -8}}) {
    SCOPED_TRACE(::testing::Message() << x_deg << ", " << y_deg);
    Accepted(Reprojected(frame_, TurnedAboutSand(x_deg, y_deg)));
  }
}

TEST_F(ScanReal, PassesNearerAndFurther) {
  for (float scale : {0.8f, 1.25f}) {
    SCOPED_TRACE(scale);
    // Depth and pixels together, about the optical axis: the same box from another distance.
    Accepted(
        Warped(frame_, {1 / scale, 0, 256 - 256 / scale, 0, 1 / scale, 212 - 212 / scale}, scale));
    Eigen::Isometry3d moved = Eigen::Isometry3d::Identity();
    moved.translation().z() = 1.26 * (scale - 1);
    Accepted(Reprojected(frame_, moved));
    // Depth alone: a box of another size.
    Accepted(Warped(frame_, {1, 0, 0, 0, 1, 0}, scale), scale);
  }
}

TEST_F(ScanReal, PassesWithAFifthOfThePixelsDropped) {
  for (uint64_t seed = 0; seed < 3; ++seed) {
    RandomStream stream(seed);
    DepthFrame dropped = frame_;
    for (float& z : dropped.depth_m)
      if (stream.Uniform() < 0.2) z = 0;
    const ScanResult scan = Accepted(dropped);
    EXPECT_NEAR(scan.invalid_share, 0.2, 0.01);
    EXPECT_LT(scan.interpolated_share, 0.03);
  }
}

// Beyond what is asked of it the scan may miss a wall by its blurred foot; then it says so.
TEST_F(ScanReal, SaysWhenAWallIsNotClear) {
  const DepthFrame tilted = Reprojected(frame_, TurnedAboutSand(0, 8));
  EXPECT_THAT(ScanDepth({&tilted, 1}, kKinect, {}).warnings,
              Contains(HasSubstr("state the box's size")));
  ScanPlace place;
  place.box_size_m = Eigen::Vector2d(1.2, 0.8);
  EXPECT_THAT(ScanDepth({&frame_, 1}, kKinect, {}, place).reasons,
              Contains(HasSubstr("the stated size is 1200 mm")));
}

// From there the robot's arm above the far wall hides it, and its own edge is the innermost one.
TEST_F(ScanReal, RefusesAnArmThatHidesAWall) {
  const DepthFrame tilted = Reprojected(frame_, TurnedAboutSand(11, 0));
  EXPECT_THAT(ScanDepth({&tilted, 1}, kKinect, {}).reasons,
              Contains(HasSubstr("a wall rises by 10 to 400 mm")));
}

TEST(ScanRealHeights, SandPassesAndTheRestIsRefused) {
  ScanConfig config;
  config.cell_size_m = 0.0038;
  const auto scan = [&](const std::string& name) {
    return ScanHeights(ReadNumpy(SharedFile("data/scans/" + name + ".npz")), 1e-3, config);
  };
  if (!std::filesystem::exists(SharedFile("data/scans/terrain_01.npz")))
    GTEST_SKIP() << "no shared scans";
  for (const char* name : {"terrain_01", "terrain_02", "terrain_03", "terrain_04", "terrain_08",
                           "terrain_09", "terrain_11_channels", "terrain_21", "terrain_22",
                           "terrain_small_110x160", "pair_a_before"})
    EXPECT_TRUE(scan(name).accepted) << name;
  const ScanResult tilted = scan("tilted_plane");
  EXPECT_TRUE(tilted.accepted);
  EXPECT_NEAR(tilted.tilt_removed_deg, 6.05, 0.05);  // at 3.8 mm a cell
  EXPECT_THAT(scan("reject_not_sand").reasons, Contains(HasSubstr("the heights span 764 mm")));
  EXPECT_THAT(scan("terrain_10_with_object").reasons, Contains(HasSubstr("encloses 34.2 cm^2")));
}

}  // namespace
}  // namespace sandwright
