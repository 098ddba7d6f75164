// The picture of a depth camera seen along a vertical, and walks over it.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "data/camera.h"
#include "data/point_cloud.h"

namespace sandwright {

// The cloud in a level frame L: origin at the camera, z up, x the level part of the camera's x.
struct LevelImage {
  // `up_C`: unit vector in C.
  LevelImage(const PointCloud& cloud, const CameraModel& camera_, const Eigen::Vector3d& up_C);

  // The reading nearest to a pixel; null outside the picture, NaN where the camera saw nothing.
  const Eigen::Vector3f* At(const Eigen::Vector2d& pixel) const;
  // The pixel that looks at a point of L, the lens taken as free of distortion: good enough to lay
  // scan lines, since each reading brings its own x and y.
  Eigen::Vector2d Pixel(const Eigen::Vector3d& p_L) const;

  CameraModel camera;
  Eigen::Matrix3d R_LC;
  std::vector<Eigen::Vector3f> points_L;  // [height x width]
};

// The readings on the straight line of pixels from `from` to `to`, or to the picture's edge; holes
// are left out. The walk ends where something that stands between
// camera and ground hides the ground.
std::vector<Eigen::Vector3f> ReadingsAlong(const LevelImage& image, const Eigen::Vector2d& from,
                                           const Eigen::Vector2d& to);

// Steepness [m/m, not negative] of the surface at reading i of a walk, over its two neighbours:
// over one, a millimetre of noise on pixels of 3 mm would look like a wall. 0 < i < size - 1.
double SteepnessAt(const std::vector<Eigen::Vector3f>& walk, size_t i);

}  // namespace sandwright
