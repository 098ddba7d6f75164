// Measurements for calibrating a cell, as a lab would take them: with noise, from poses that the arm
// reaches.
#pragma once

#include <spdlog/fmt/fmt.h>

#include <optional>

#include "data/base/random.h"
#include "robot_model/calibration/box_pose.h"
#include "robot_model/calibration/factory_kinematics.h"
#include "robot_model/calibration/hand_eye.h"
#include "robot_model/calibration/tool_tip.h"

namespace sandwright {

struct MeasurementNoise {
  double pixel = 0.15;      // of a corner, standard deviation a coordinate [px]
  double touch_m = 0.0004;  // of a touch, a coordinate
  double joint_rad = 3e-5;  // of the arm: what its factory calibration leaves
};

inline Eigen::Vector3d NormalVector(RandomStream& stream) {
  const double x = stream.Normal(), y = stream.Normal(), z = stream.Normal();
  return {x, y, z};
}

// The shipped cell with an arm, a camera, a blade and a box that are not where the file says.
inline Workcell TrueCell(RandomStream& stream) {
  Workcell cell;
  for (auto* list : {&cell.kinematics.theta_rad, &cell.kinematics.alpha_rad})
    for (double& value : *list) value += 5e-4 * stream.Normal();
  for (auto* list : {&cell.kinematics.a_m, &cell.kinematics.d_m})
    for (double& value : *list) value += 3e-4 * stream.Normal();
  const auto move = [&](PoseSetting& pose, double shift_m, double turn_rad) {
    Eigen::Isometry3d by = Eigen::Isometry3d::Identity();
    const Eigen::Vector3d turn = turn_rad * NormalVector(stream);
    by.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    by.translation() = shift_m * NormalVector(stream);
    pose = PoseSetting::FromIsometry(pose.ToIsometry() * by);
  };
  move(cell.tool.X_FC, 0.005, 0.03);
  move(cell.tool.X_FT, 0.004, 0);
  move(cell.X_WB, 0.01, 0.01);
  return cell;
}

// What the file says of that cell before it is calibrated: kinematics alone are known.
inline Workcell NominalCell(const Workcell& true_cell) {
  Workcell cell;
  cell.kinematics = true_cell.kinematics;
  return cell;
}

inline JointAngles Shaken(JointAngles q, const MeasurementNoise& noise, RandomStream& stream) {
  for (double& angle : q.rad) angle += noise.joint_rad * stream.Normal();
  return q;
}

// Joints that bring the flange to X_WF, if any do.
inline std::optional<JointAngles> Reach(const Workcell& cell, const Eigen::Isometry3d& X_WF) {
  const auto solutions = Ur10(cell.kinematics).Inverse(X_WF);
  if (solutions.empty()) return std::nullopt;
  return solutions.front().q;
}

struct HandEyeMeasurements {
  std::vector<MarkedFrame> frames;
  std::vector<JointAngles> joints;
};

// `tilt_rad`: how far the camera leans to either side; it also turns about its axis by as much.
inline HandEyeMeasurements MeasureHandEye(const Workcell& cell, const CharucoBoard& board,
                                          size_t count, const MeasurementNoise& noise,
                                          RandomStream& stream, double tilt_rad = 0.45) {
  const Eigen::Vector3d centre_B(cell.box.width_m / 2, cell.box.depth_m / 2 - 0.1, 0.05);
  const Eigen::Isometry3d X_WBoard =
      cell.X_WB.ToIsometry() * Eigen::Translation3d(centre_B) *
      Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()) *
      Eigen::Translation3d(-board.columns * board.square_m / 2, -board.rows * board.square_m / 2, 0);
  HandEyeMeasurements result;
  while (result.frames.size() < count) {
    const double range_m = stream.Uniform(0.45, 0.65);
    const Eigen::Isometry3d X_WC =
        X_WBoard *
        Eigen::Translation3d(board.columns * board.square_m / 2, board.rows * board.square_m / 2,
                             0) *
        Eigen::AngleAxisd(stream.Uniform(-tilt_rad, tilt_rad), Eigen::Vector3d::UnitX()) *
        Eigen::AngleAxisd(stream.Uniform(-tilt_rad, tilt_rad), Eigen::Vector3d::UnitY()) *
        Eigen::AngleAxisd(stream.Uniform(-0.5, 0.5), Eigen::Vector3d::UnitZ()) *
        Eigen::Translation3d(0.04 * stream.Normal(), 0.03 * stream.Normal(), -range_m);
    const auto q = Reach(cell, X_WC * cell.tool.X_FC.ToIsometry().inverse());
    if (!q) continue;
    const Eigen::Isometry3d X_CBoard =
        (Ur10(cell.kinematics).Forward(Shaken(*q, noise, stream)) * cell.tool.X_FC.ToIsometry())
            .inverse() *
        X_WBoard;
    MarkedFrame frame{fmt::format("frame_{:02}.png", result.frames.size()), {}};
    // All of them or none: the frame is taken anew where the board does not fit in, so that the
    // order of the corners is their number.
    for (const Eigen::Vector3d& corner : board.Corners()) {
      const Eigen::Vector3d p_C = X_CBoard * corner;
      const Eigen::Vector2d pixel(
          cell.camera.fx_px * p_C.x() / p_C.z() + cell.camera.cx_px + noise.pixel * stream.Normal(),
          cell.camera.fy_px * p_C.y() / p_C.z() + cell.camera.cy_px +
              noise.pixel * stream.Normal());
      if (pixel.minCoeff() > 0 && pixel.x() < static_cast<double>(cell.camera.width - 1) &&
          pixel.y() < static_cast<double>(cell.camera.height - 1))
        frame.points.push_back({static_cast<int>(frame.points.size()), pixel});
    }
    if (frame.points.size() < board.Corners().size()) continue;
    result.frames.push_back(frame);
    result.joints.push_back(*q);
  }
  return result;
}

// The tip on one point in the box from `count` sides, leaning by up to `tilt_rad`; with the edge's
// ends.
inline ToolTouches MeasureTool(const Workcell& cell, size_t count, const MeasurementNoise& noise,
                               RandomStream& stream, double tilt_rad = 0.5) {
  const Ur10 arm(cell.kinematics);
  const Eigen::Vector3d point_W = cell.X_WB.ToIsometry() * Eigen::Vector3d(0.6, 0.25, 0.1);
  const auto touch = [&](const Eigen::Vector3d& p_T) {
    for (;;) {
      const Eigen::Matrix3d R_WT =
          (Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()) *
           Eigen::AngleAxisd(stream.Uniform(-tilt_rad, tilt_rad), Eigen::Vector3d::UnitX()) *
           Eigen::AngleAxisd(stream.Uniform(-tilt_rad, tilt_rad), Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(stream.Uniform(-2 * tilt_rad, 2 * tilt_rad),
                             Eigen::Vector3d::UnitZ()))
              .toRotationMatrix();
      Eigen::Isometry3d X_WT = Eigen::Isometry3d::Identity();
      X_WT.linear() = R_WT;
      X_WT.translation() = point_W + noise.touch_m * NormalVector(stream) - R_WT * p_T;
      const auto q = Reach(cell, X_WT * cell.tool.X_FT.ToIsometry().inverse());
      if (q) return Shaken(*q, noise, stream);
    }
  };
  ToolTouches touches;
  for (size_t i = 0; i < count; ++i) touches.tip.push_back(touch(Eigen::Vector3d::Zero()));
  const Eigen::Vector3d half(0, cell.tool.blade.width_m / 2, 0);
  touches.edge = {touch(-half), touch(half)};
  return touches;
}

// Two touches on each wall's rim, 150 mm from its ends.
inline std::vector<RimTouch> MeasureRim(const Workcell& cell, const MeasurementNoise& noise,
                                        RandomStream& stream) {
  const double w = cell.box.width_m, d = cell.box.depth_m, h = cell.box.wall_height_m, in = 0.15;
  std::vector<RimTouch> touches = {
      {"x0", {0, in, h}}, {"x0", {0, d - in, h}}, {"x1", {w, in, h}}, {"x1", {w, d - in, h}},
      {"y0", {in, 0, h}}, {"y0", {w - in, 0, h}}, {"y1", {in, d, h}}, {"y1", {w - in, d, h}}};
  for (RimTouch& touch : touches)
    touch.p_W = cell.X_WB.ToIsometry() * touch.p_W + noise.touch_m * NormalVector(stream);
  return touches;
}

// Tags on the four corners of the rim, seen from the camera pose and from three poses around it.
inline std::vector<PointSight> MeasureTags(const Workcell& cell, const MeasurementNoise& noise,
                                           RandomStream& stream) {
  std::vector<PointSight> sights;
  for (int frame = 0; frame < 4; ++frame) {
    JointAngles q = cell.camera_pose();
    for (double& angle : q.rad) angle += frame == 0 ? 0 : 0.02 * stream.Normal();
    const auto X_FC = cell.tool.X_FC.ToIsometry();
    const Eigen::Isometry3d X_WC =
        Ur10(cell.kinematics).Forward(Shaken(q, noise, stream)) * X_FC;
    for (const double x : {0.0, cell.box.width_m})
      for (const double y : {0.0, cell.box.depth_m}) {
        const Eigen::Vector3d p_B(x, y, cell.box.wall_height_m);
        const Eigen::Vector3d p_C = X_WC.inverse() * cell.X_WB.ToIsometry() * p_B;
        sights.push_back({fmt::format("frame {} tag {}", frame, sights.size() % 4), p_B,
                          Ur10(cell.kinematics).Forward(q) * X_FC,
                          {p_C.x() / p_C.z() + noise.pixel * stream.Normal() / cell.camera.fx_px,
                           p_C.y() / p_C.z() + noise.pixel * stream.Normal() / cell.camera.fy_px,
                           1}});
      }
  }
  return sights;
}

}  // namespace sandwright
