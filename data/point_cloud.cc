#include "data/point_cloud.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "data/base/error.h"

namespace sandwright {
namespace {

// The middle of the readings of the 5 x 5 pixels around (u, v), the mean of the five in the middle
// of their order, less what lies across a jump; 0 where there is none. The median alone would come
// in the camera's whole millimetres, which over two pixels are as much as the difference between
// sand at rest and a wall.
float LocalMedian(const DepthFrame& frame, int u, int v) {
  constexpr int radius = 2;
  constexpr float kJump_m = 0.003f;
  std::array<float, (2 * radius + 1) * (2 * radius + 1)> window;
  size_t n = 0;
  for (int b = std::max(v - radius, 0); b <= std::min(v + radius, frame.height - 1); ++b)
    for (int a = std::max(u - radius, 0); a <= std::min(u + radius, frame.width - 1); ++a)
      if (const float z = frame.At(a, b); z > 0) window[n++] = z;
  if (n == 0) return 0;
  std::sort(window.begin(), window.begin() + static_cast<std::ptrdiff_t>(n));
  const size_t half = std::min<size_t>(2, (n - 1) / 2), middle = n / 2;
  float sum = 0, count = 0;
  for (size_t k = middle - half; k <= middle + half; ++k)
    if (std::abs(window[k] - window[middle]) < kJump_m) sum += window[k], ++count;
  return sum / count;
}

}  // namespace

PointCloud ToPoints(const DepthFrame& frame, const CameraModel& camera) {
  if (frame.width != camera.width || frame.height != camera.height)
    throw Error(
        fmt::format("the depth frame has {} x {} px (columns x rows); the camera model has "
                    "{} x {}: name the right one with --camera",
                    frame.width, frame.height, camera.width, camera.height));
  if (std::ranges::none_of(frame.depth_m, [](float z) { return z > 0; }))
    throw Error("the depth frame holds no reading: every pixel is 0");
  const std::vector<PixelRay> rays = PixelRays(camera);
  PointCloud cloud{frame.width, frame.height, {}};
  cloud.points_m.reserve(rays.size());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (size_t i = 0; i < rays.size(); ++i) {
    const float z = frame.depth_m[i];
    cloud.points_m.push_back(z > 0 ? Eigen::Vector3f(rays[i].x * z, rays[i].y * z, z)
                                   : Eigen::Vector3f(nan, nan, nan));
  }
  return cloud;
}

DepthFrame MedianFiltered(const DepthFrame& frame) {
  DepthFrame out{frame.width, frame.height, {}};
  out.depth_m.reserve(frame.depth_m.size());
  for (int v = 0; v < frame.height; ++v)
    for (int u = 0; u < frame.width; ++u) out.depth_m.push_back(LocalMedian(frame, u, v));
  return out;
}

DepthFrame WithoutFlyingPixels(const DepthFrame& frame, const DepthFrame& median, double limit_m) {
  DepthFrame out = frame;
  for (size_t i = 0; i < out.depth_m.size(); ++i)
    if (std::abs(out.depth_m[i] - median.depth_m[i]) > limit_m) out.depth_m[i] = 0;
  return out;
}

Plane FitPlane(const std::vector<Eigen::Vector3f>& points) {
  SAND_CHECK(points.size() >= 3, points.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : points) mean += p.cast<double>();
  mean /= static_cast<double>(points.size());
  std::vector<float> residuals(points.size());
  Eigen::Vector3d solution = Eigen::Vector3d::Zero();  // slopes and offset about the mean
  double scale = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 15; ++round) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d p = points[i].cast<double>() - mean;
      const double r = round == 0 ? 0 : residuals[i] / scale, weight = 1 / (1 + r * r);
      const Eigen::Vector3d row(p.x(), p.y(), 1);
      normal += weight * row * row.transpose();
      right += weight * p.z() * row;
    }
    const Eigen::Vector3d previous = solution;
    solution = normal.ldlt().solve(right);
    SAND_CHECK(solution.allFinite(), points.size());
    for (size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d p = points[i].cast<double>() - mean;
      residuals[i] =
          static_cast<float>(p.z() - solution.x() * p.x() - solution.y() * p.y() - solution.z());
    }
    if (round > 0 && (solution - previous).norm() < 1e-7) break;
    std::vector<float> sizes = residuals;
    for (float& size : sizes) size = std::abs(size);
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    // 1.48 turns a median into a standard deviation, 2.4 is the usual Cauchy constant.
    scale = std::max(2.4 * 1.48 * static_cast<double>(*middle), 1e-6);
  }
  return {solution.x(), solution.y(),
          mean.z() + solution.z() - solution.x() * mean.x() - solution.y() * mean.y()};
}

Eigen::Matrix3d LevelRotation(const Eigen::Vector3d& up_C) {
  const Eigen::Vector3d x = (Eigen::Vector3d::UnitX() - up_C.x() * up_C).normalized();
  Eigen::Matrix3d rotation;
  rotation << x.transpose(), up_C.cross(x).transpose(), up_C.transpose();
  return rotation;
}

}  // namespace sandwright
