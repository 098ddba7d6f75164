// Random strokes of every class, good and bad, for tests and benchmarks of the arm.
#pragma once

#include <cmath>
#include <numbers>

#include "data/base/random.h"
#include "data/stroke.h"

namespace sandwright {

// 2-4 control points in a cube of 240 mm somewhere in a box of `width_m` x `depth_m` (they may
// leave it), the edge between 0 and 60 mm above the floor; lines, polylines and curves.
inline Stroke RandomStroke(double width_m, double depth_m, RandomStream& random) {
  for (;;) {
    Stroke stroke;
    const auto points = 2 + random.Index(3);
    stroke.degree = random.Uniform() < 0.5 ? 1 : 2;
    stroke.speed_mps = random.Uniform(0.05, 0.15);
    const Eigen::Vector3d corner(random.Uniform(-0.02, width_m - 0.1),
                                 random.Uniform(-0.02, depth_m - 0.1), 0);
    for (uint64_t i = 0; i < points; ++i)
      stroke.control_points_m.push_back(corner + Eigen::Vector3d(random.Uniform(0, 0.24),
                                                                 random.Uniform(0, 0.24),
                                                                 random.Uniform(0.0, 0.06)));
    bool apart = true;
    for (size_t i = 1; i < points; ++i)
      apart &=
          (stroke.control_points_m[i] - stroke.control_points_m[i - 1]).head<2>().norm() > 0.005;
    if (apart) return stroke;
  }
}

// A straight stroke as a policy draws it: `length_m` long around (x, y), 20 mm above the floor.
inline Stroke TypicalStroke(double x_m, double y_m, double heading_rad, double length_m = 0.12) {
  const Eigen::Vector3d middle(x_m, y_m, 0.02),
      half(0.5 * length_m * std::cos(heading_rad), 0.5 * length_m * std::sin(heading_rad), 0);
  return {{middle - half, middle + half}, 1, 0.1};
}

}  // namespace sandwright
