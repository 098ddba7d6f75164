#include "data/depth_frame.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/npy.h"
#include "data/point_cloud.h"

namespace sandwright {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

auto Fails(const std::string& text) {
  return ::testing::Throws<Error>(::testing::Property(&Error::what, HasSubstr(text)));
}
std::string Temp(const std::string& name) { return ::testing::TempDir() + "depth_" + name; }

TEST(DepthFrame, ComesBackFromPngAndNpy) {
  const DepthFrame frame{3, 2, {0, 1.234f, 2, 0.001f, 65.0f, 0}};
  for (const char* name : {"frame.png", "frame.npy"}) {
    WriteDepthFrame(frame, Temp(name));
    const DepthFrame back = ReadDepthFrame(Temp(name));
    EXPECT_EQ(back.width, 3);
    EXPECT_EQ(back.height, 2);
    for (size_t i = 0; i < 6; ++i) EXPECT_FLOAT_EQ(back.depth_m[i], frame.depth_m[i]) << name;
  }
  EXPECT_FLOAT_EQ(ReadDepthFrame(Temp("frame.png"), "0.1mm").depth_m[1], 0.1234f);
}

TEST(DepthFrame, NamesTheFaultOfBadFiles) {
  cv::imwrite(Temp("grey.png"), cv::Mat(4, 4, CV_8U, cv::Scalar(7)));
  WriteFileAtomically(Temp("text.png"), "not a picture");
  const std::vector<double> heights(4);
  WriteNpy<double>(Temp("heights.npy"), heights, {2, 2});
  const std::vector<uint16_t> line(4);
  WriteNpy<uint16_t>(Temp("line.npy"), line, {4});
  EXPECT_THAT([] { ReadDepthFrame(Temp("grey.png")); }, Fails("1 of 8 bits"));
  EXPECT_THAT([] { ReadDepthFrame(Temp("text.png")); }, Fails("not a picture"));
  EXPECT_THAT([] { ReadDepthFrame(Temp("none.png")); }, Fails("none.png"));
  EXPECT_THAT([] { ReadDepthFrame(Temp("heights.npy")); }, Fails("f8 of rank 2"));
  EXPECT_THAT([] { ReadDepthFrame(Temp("line.npy")); }, Fails("u2 of rank 1"));
  EXPECT_THAT([] { ReadDepthFrame(Temp("line.npy"), "inch"); }, Fails("allowed: mm, m"));
}

TEST(DepthFrame, FusesByTheMedianOfTheReadings) {
  const std::vector<DepthFrame> frames = {
      {2, 2, {1, 0, 5, 0}}, {2, 2, {2, 0, 1, 0}}, {2, 2, {9, 3, 0, 0}}};
  EXPECT_THAT(FuseFrames(frames).depth_m, ElementsAre(2, 3, 3, 0));
  const std::vector<DepthFrame> other = {{2, 1, {1, 1}}, {1, 2, {1, 1}}};
  EXPECT_THAT([&] { FuseFrames(other); }, Fails("2 x 1 and 1 x 2"));
  EXPECT_THAT([] { FuseFrames({}); }, Fails("no depth frame"));
}

TEST(PointCloud, UndistortsRays) {
  CameraModel camera;
  camera.k1 = 0.1;
  const std::vector<PixelRay> rays = PixelRays(camera);
  // x (1 + k1 x^2) = 240/366 on the middle row: the pixel 240 px right of the axis.
  const PixelRay ray = rays[212 * 512 + 496];
  const double x = ray.x;
  EXPECT_NEAR(x * (1 + 0.1 * x * x), 240.0 / 366, 1e-6);
  EXPECT_NEAR(ray.y, 0, 1e-9);
}

TEST(PointCloud, RefusesFramesThatDoNotFitTheCamera) {
  CameraModel camera;
  camera.width = 16, camera.height = 8;
  EXPECT_THAT([&] { ToPoints({8, 16, std::vector<float>(128, 1)}, camera); }, Fails("8 x 16 px"));
  EXPECT_THAT(
      [&] {
        ToPoints({16, 8, std::vector<float>(128, 0)}, camera);
      },
      Fails("every pixel is 0"));
  EXPECT_THAT([&] { ToPoints({1, 1, {1}}, camera); }, Fails("1 x 1 px"));
}

TEST(PointCloud, PlaneIgnoresAHeap) {
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < 400; ++i) {
    const float x = 0.05f * static_cast<float>(i % 20), y = 0.05f * static_cast<float>(i / 20);
    const bool heap = x > 0.6f && y > 0.5f;
    points.emplace_back(x, y, 0.1f * x - 0.2f * y + 0.3f + (heap ? 0.08f : 0));
  }
  const Plane plane = FitPlane(points);
  EXPECT_NEAR(plane.slope_x, 0.1, 1e-3);
  EXPECT_NEAR(plane.slope_y, -0.2, 1e-3);
  EXPECT_NEAR(plane.offset, 0.3, 1e-3);
  EXPECT_NEAR(plane.tilt_rad(), std::atan(std::sqrt(0.05)), 1e-3);
}

TEST(PointCloud, LevelRotationIsRightHandedWithZUp) {
  const Eigen::Vector3d up = Eigen::Vector3d(0.1, -0.2, -1).normalized();
  const Eigen::Matrix3d R_LC = LevelRotation(up);
  EXPECT_NEAR((R_LC * up - Eigen::Vector3d::UnitZ()).norm(), 0, 1e-12);
  EXPECT_NEAR((R_LC * R_LC.transpose() - Eigen::Matrix3d::Identity()).norm(), 0, 1e-12);
  EXPECT_NEAR(R_LC.determinant(), 1, 1e-12);
}

}  // namespace
}  // namespace sandwright
