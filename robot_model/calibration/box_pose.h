// Where the box stands: from touches of its rim, from its corner tags in the camera's pictures, or
// from both, which must then agree.
#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "robot_model/calibration/cell_calibration.h"

namespace sandwright {

// The tool's tip on the inner upper edge of a wall or, with two walls, in a corner of the rim.
struct RimTouch {
  std::string at;  // "x0": the wall x = 0, "x1": x = width, "y0", "y1"; corners "x0y0" .. "x1y1"
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
};

// A point whose place in B is known, seen by the camera on the arm.
struct PointSight {
  std::string name;                                  // frame and tag, for messages
  Eigen::Vector3d p_B = Eigen::Vector3d::Zero();
  Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();
  Eigen::Vector3d ray_C = Eigen::Vector3d::UnitZ();  // towards it, z = 1
};

struct BoxMeasurements {
  std::vector<RimTouch> touches;
  std::vector<PointSight> sights;
};

struct BoxCalibration {
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  CalibrationError error;
  double dilution = 0;                     // worst corner's error, in errors of one measurement
  std::optional<double> width_m, depth_m;  // where opposite walls were touched
  std::optional<double> disagreement_m;    // of touches and tags, at the corner where it is largest
};

// Measurements that lie further from the box than this are of something else.
inline constexpr double kBoxTolerance_m = 0.003;
// Corners that the measurements leave more uncertain than this many times their own error.
inline constexpr double kMaxBoxDilution = 4;

// Least squares over the six numbers of X_WB, the box having the size that the cell says; starts from
// the cell's X_WB. Throws Error (kRefused) with reasons: too few measurements or too alike (with the
// dilution), one that belongs elsewhere (which, by how much), touches and tags that disagree, a width
// or depth that differs from the cell's; each with figure and limit.
BoxCalibration CalibrateBox(const BoxMeasurements& measurements, const Workcell& workcell);

}  // namespace sandwright
