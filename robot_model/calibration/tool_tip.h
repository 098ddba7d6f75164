// Where the blade is on the flange: touches of one fixed point from several sides.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <filesystem>
#include <optional>
#include <vector>

#include "robot_model/calibration/cell_calibration.h"
#include "robot_model/ur10.h"

namespace sandwright {

// Joint vectors at which the blade's edge stood on one and the same point.
struct ToolTouches {
  std::vector<JointAngles> tip;                    // with its middle, four or more
  std::optional<std::array<JointAngles, 2>> edge;  // with its end at -y of T, then at +y
};

// YAML: `tip`: a list of joint vectors; `edge`, optional: two of them. Throws Error naming the entry.
ToolTouches ReadToolTouches(const std::filesystem::path& file);

struct ToolCalibration {
  Eigen::Isometry3d X_FT = Eigen::Isometry3d::Identity();
  CalibrationError error;
  double dilution = 0;       // worst error of the tip, in errors of one touch
  double edge_length_m = 0;  // between the two ends; 0 where they were not touched
};

// Touches disagree by more than this where one of them was not on the point.
inline constexpr double kTouchTolerance_m = 0.003;
// The tip of poses that are too alike is a multiple of a touch's error away.
inline constexpr double kMaxDilution = 3;

// Least squares over the tip's touches. The orientation: y of T along the two ends, z as near to z of
// F as that allows; without them that of the cell stays. Throws Error (kRefused) with reasons: fewer
// than four touches, poses too alike (with the dilution), a touch off the point (which one, by how
// much), ends that do not lie about the tip or not the blade's width apart.
ToolCalibration CalibrateTool(const ToolTouches& touches, const Workcell& workcell);

}  // namespace sandwright
