// A board in one frame, and the hand-eye problem over several such views.
#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "data/camera.h"
#include "robot_model/calibration/marked_frames.h"

namespace sandwright {

struct BoardView {
  std::string name;
  Eigen::Isometry3d X_WF = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d X_CBoard = Eigen::Isometry3d::Identity();
  std::vector<cv::Point3d> corners_Board;  // those that were seen [m]
  std::vector<cv::Point2d> pixels;
};

// The board's pose in C by solvePnP. Throws Error (kRefused; one reason) where fewer than eight
// corners are seen, an id is not the board's, or they miss its shape by more than 1 px rms.
BoardView ViewBoard(const MarkedFrame& frame, const Eigen::Isometry3d& X_WF,
                    const CharucoBoard& board, const CameraModel& camera);

struct HandEye {
  Eigen::Isometry3d X_FC = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d X_WBoard = Eigen::Isometry3d::Identity();

  // The board in W as a view has it.
  Eigen::Isometry3d BoardOf(const BoardView& view) const {
    return view.X_WF * X_FC * view.X_CBoard;
  }
};

// OpenCV's solvers by name.
inline constexpr const char* kHandEyeSolvers[] = {"tsai", "park", "horaud", "andreff",
                                                  "daniilidis"};
// One of them over the views `in`, three or more; X_WBoard is the mean over these. A solver that
// fails on the set gives poses that are not finite.
HandEye SolveHandEye(const std::vector<BoardView>& views, const std::vector<size_t>& in,
                     const std::string& solver);

// `start` moved to the least squares of the pixels, over both poses (Levenberg-Marquardt).
HandEye PolishHandEye(const std::vector<BoardView>& views, const std::vector<size_t>& in,
                      const CameraModel& camera, const HandEye& start);

}  // namespace sandwright
