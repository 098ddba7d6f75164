// Depth frames as points in the camera's frame, and as points seen along a chosen vertical.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "data/camera.h"
#include "data/depth_frame.h"

namespace sandwright {

// One point per pixel, in the frame's own order, so that neighbours in the picture stay neighbours.
// A pixel without a reading is NaN in all coordinates.
struct PointCloud {
  int width = 0, height = 0;
  std::vector<Eigen::Vector3f> points_m;  // [height x width]

  const Eigen::Vector3f& At(int u, int v) const {
    return points_m[static_cast<size_t>(v) * static_cast<size_t>(width) + static_cast<size_t>(u)];
  }
};

// Points in C. Throws Error where the frame has another size than the camera, or holds no reading.
PointCloud ToPoints(const DepthFrame& frame, const CameraModel& camera);

// The frame with each pixel the middle of the readings around it (5 x 5; the mean of the few about the
// median, so that fractions of the camera's steps survive), which keeps straight edges and closes holes
// of a few pixels: for finding edges, not for measuring heights.
DepthFrame MedianFiltered(const DepthFrame& frame);

// The frame without readings that stand alone, further than `limit_m` from `median`, its median
// filtered version: flying pixels on edges.
DepthFrame WithoutFlyingPixels(const DepthFrame& frame, const DepthFrame& median, double limit_m);

// z = slope_x x + slope_y y + offset in whatever frame the points are given.
struct Plane {
  double slope_x = 0, slope_y = 0, offset = 0;
  double tilt_rad() const { return std::atan(std::hypot(slope_x, slope_y)); }
};

// Robust plane through points, least squares with Cauchy weights at the scale of the median
// residual: a heap or a hole of less than half the area hardly turns
// it. Needs 3 points, not in line.
Plane FitPlane(const std::vector<Eigen::Vector3f>& points);

// The rotation R_LC into a level frame L: its z is `up_C` (unit vector in C), its x the part of the
// camera's x across it.
Eigen::Matrix3d LevelRotation(const Eigen::Vector3d& up_C);

}  // namespace sandwright
