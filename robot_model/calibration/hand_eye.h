// Where the camera is on the flange: a board that does not move, seen from many poses.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "robot_model/calibration/cell_calibration.h"
#include "robot_model/calibration/marked_frames.h"

namespace sandwright {

// One solver's error over frames that it was not given.
struct HandEyeSolver {
  std::string name;  // OpenCV's five, and "reprojection" (the best of them polished in pixels)
  double held_out_m = 0, held_out_rad = 0;
};

struct HandEyeCalibration {
  Eigen::Isometry3d X_FC = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d X_WBoard = Eigen::Isometry3d::Identity();
  CalibrationError error;  // of the board's middle in W, and of its orientation
  std::string solver;      // the one taken
  std::vector<HandEyeSolver> solvers;
  double rotation_spread_rad = 0;    // of the flange about its second axis, rms over pairs
  std::vector<std::string> refused;  // frames left out: name and reason
};

// Fewer leave too little to hold out.
inline constexpr size_t kMinHandEyeFrames = 8;
// Turning about one axis alone leaves the camera's place along that axis open.
inline constexpr double kMinRotationSpread_rad = 0.15;

// `frames` and `joints` belong together one by one. Frames are left out by name where the board is
// hardly seen or bent (not this board, or wrong correspondences) or stands elsewhere than the other
// frames say (joints of another picture). Throws Error (kRefused) with reasons: fewer than
// kMinHandEyeFrames left, more than a quarter left out, too little rotation. Throws Error where the
// lists differ in length.
HandEyeCalibration CalibrateHandEye(const std::vector<MarkedFrame>& frames,
                                    const std::vector<JointAngles>& joints,
                                    const CharucoBoard& board, const Workcell& workcell);

}  // namespace sandwright
