#include "data/level_image.h"

#include <algorithm>
#include <cmath>

namespace sandwright {

using Eigen::Vector2d;
using Eigen::Vector3f;

// A reading that lies this much nearer to the walk's start than an earlier one belongs to something
// above the ground that hides it. Noise and leaning walls stay below.
constexpr double kHidden_m = 0.025;

LevelImage::LevelImage(const PointCloud& cloud, const CameraModel& camera_,
                       const Eigen::Vector3d& up_C)
    : camera(camera_), R_LC(LevelRotation(up_C)) {
  const Eigen::Matrix3f rotation = R_LC.cast<float>();
  points_L.reserve(cloud.points_m.size());
  for (const Vector3f& p : cloud.points_m) points_L.push_back(rotation * p);
}

const Vector3f* LevelImage::At(const Vector2d& pixel) const {
  const int64_t u = std::lround(pixel.x()), v = std::lround(pixel.y());
  if (u < 0 || v < 0 || u >= camera.width || v >= camera.height) return nullptr;
  return &points_L[static_cast<size_t>(v * camera.width + u)];
}

Vector2d LevelImage::Pixel(const Eigen::Vector3d& p_L) const {
  const Eigen::Vector3d p_C = R_LC.transpose() * p_L;
  return {camera.fx_px * p_C.x() / p_C.z() + camera.cx_px,
          camera.fy_px * p_C.y() / p_C.z() + camera.cy_px};
}

std::vector<Vector3f> ReadingsAlong(const LevelImage& image, const Vector2d& from,
                                    const Vector2d& to) {
  const double length = (to - from).norm();
  const Vector2d step = (to - from) / std::max(length, 1e-9);
  std::vector<Vector3f> readings;
  const Vector3f* last = nullptr;
  double furthest = 0;
  for (double t = 0; t <= length; t += 1) {
    const Vector3f* p = image.At(from + t * step);
    if (p == nullptr) break;
    if (p == last || !p->allFinite()) continue;
    last = p;
    if (!readings.empty()) {
      const double distance = (p->head<2>() - readings.front().head<2>()).norm();
      if (distance < furthest - kHidden_m) break;
      furthest = std::max(furthest, distance);
    }
    readings.push_back(*p);
  }
  return readings;
}

double SteepnessAt(const std::vector<Vector3f>& walk, size_t i) {
  const Vector3f difference = walk[i + 1] - walk[i - 1];
  return std::abs(difference.z()) / std::max(difference.head<2>().norm(), 1e-6f);
}

}  // namespace sandwright
