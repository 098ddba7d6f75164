#include "robot_model/workcell.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "data/base/error.h"
#include "data/base/sha256.h"

namespace sandwright {
namespace {

void CheckLength(const std::vector<double>& list, size_t length, const std::string& source,
                 const char* key) {
  if (list.size() != length)
    throw Error(
        fmt::format("{}: {} has {} numbers; {} are needed", source, key, list.size(), length));
}

void CheckPose(const PoseSetting& pose, const std::string& source, const std::string& key) {
  CheckLength(pose.translation_m, 3, source, (key + ".translation_m").c_str());
  CheckLength(pose.rotation_vector_rad, 3, source, (key + ".rotation_vector_rad").c_str());
}

void CheckJoints(const std::vector<double>& joints, const MotionLimits& limits,
                 const std::string& source, const char* key) {
  CheckLength(joints, 6, source, key);
  for (size_t i = 0; i < 6; ++i) {
    const double limit = limits.joint_position_rad[i] - limits.position_margin_rad;
    if (std::abs(joints[i]) > limit)
      throw Error(
          fmt::format("{}: {}: joint {} at {:.4f} rad; allowed: +-{:.4f} (limit less margin)",
                      source, key, i + 1, joints[i], limit));
  }
}

// The safety-rated layer is the last one: ours must have stopped the arm before it does.
void CheckPendant(const MotionLimits& limits, const std::string& source) {
  const auto check = [&](const char* key, double ours, double pendant, double tolerance,
                         const char* unit) {
    if (ours > pendant - tolerance)
      throw Error(fmt::format(
          "{}: limits.{} = {}; allowed: up to {:.4g} {} (the pendant's {} less its tolerance {})",
          source, key, ours, pendant - tolerance, unit, pendant, tolerance));
  };
  check("tcp_speed_mps", limits.tcp_speed_mps, limits.pendant_tcp_speed_mps,
        MotionLimits::kPendantSpeedTolerance_mps, "m/s");
  check("contact_force_n", limits.contact_force_n, limits.pendant_force_n,
        MotionLimits::kPendantForceTolerance_n, "N");
}

template <class Component>
std::string HashOf(Component component) {
  return Sha256Hex(ToJson(FieldsOf(component)).dump());
}

}  // namespace

Eigen::Isometry3d PoseSetting::ToIsometry() const {
  const Eigen::Map<const Eigen::Vector3d> translation(translation_m.data());
  const Eigen::Vector3d turn(rotation_vector_rad[0], rotation_vector_rad[1],
                             rotation_vector_rad[2]);
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  if (turn.norm() > 0)
    X.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  X.translation() = translation;
  return X;
}

PoseSetting PoseSetting::FromIsometry(const Eigen::Isometry3d& X) {
  const Eigen::AngleAxisd turn(X.linear());
  const Eigen::Vector3d p = X.translation(), r = turn.angle() * turn.axis();
  return {{p.x(), p.y(), p.z()}, {r.x(), r.y(), r.z()}};
}

void MotionLimits::Fields(FieldList& f) {
  f.Add("joint_position_rad", joint_position_rad, "largest |angle| a joint, base first [rad]", 0,
        6.2832);
  f.Add("joint_speed_radps", joint_speed_radps, "rated speed a joint [rad/s]", 0.01, 3.1416);
  f.Add("joint_acceleration_radps2", joint_acceleration_radps2, "of any joint [rad/s^2]", 0.1,
        5.236);
  f.Add("joint_jerk_radps3", joint_jerk_radps3, "of any joint [rad/s^3]", 1, 1000);
  f.Add("tcp_speed_mps", tcp_speed_mps, "of the blade along a stroke [m/s]", 0.001, 1);
  f.Add("tcp_acceleration_mps2", tcp_acceleration_mps2, "of the blade [m/s^2]", 0.01, 2.5);
  f.Add("share_of_speed", share_of_speed, "of the speeds that may be used", 0.01, 1);
  f.Add("share_of_acceleration", share_of_acceleration,
        "of accelerations and jerk that may be used", 0.01, 1);
  f.Add("position_margin_rad", position_margin_rad, "kept from the joint limits [rad]", 0, 1);
  f.Add("min_singular_value", min_singular_value, "of the flange Jacobian (m, rad)", 0, 1);
  f.Add("clearance_m", clearance_m, "links to walls, table, sand and other links [m]", 0, 0.2);
  f.Add("wall_margin_m", wall_margin_m, "blade to the box walls [m]", 0, 0.2);
  f.Add("floor_margin_m", floor_margin_m, "blade's edge above the box floor [m]", 0, 0.1);
  f.Add("max_cut_m", max_cut_m, "sand above the blade's edge [m]", 0, 0.5);
  f.Add("max_extent_m", max_extent_m, "of the control points along each axis [m]", 0.01, 2);
  f.Add("min_bend_radius_m", min_bend_radius_m, "of a curved stroke's path in the plane [m]",
        0.0005, 1);
  f.Add("min_curve_speed_share", min_curve_speed_share,
        "share of its speed to which abrupt bends may slow a curve", 0, 1);
  f.Add("max_duration_s", max_duration_s, "of one stroke [s]", 0.1, 3600);
  f.Add("contact_force_n", contact_force_n,
        "by which a stroke may exceed the same one in the air [N]", 5, 200);
  f.Add("pendant_tcp_speed_mps", pendant_tcp_speed_mps, "safety limit set at the pendant [m/s]",
        0.1, 5);
  f.Add("pendant_force_n", pendant_force_n, "safety limit set at the pendant [N]", 50, 250);
}

void MotionSettings::Fields(FieldList& f) {
  f.Add("retreat_height_m", retreat_height_m,
        "blade's edge above the box floor between strokes [m]", 0, 1);
  f.Add("path_acceleration_mps2", path_acceleration_mps2, "along the path [m/s^2]", 0.01, 2.5);
  f.Add("turn_speed_radps", turn_speed_radps, "of the blade about its axis [rad/s]", 0.01, 3);
  f.Add("turn_acceleration_radps2", turn_acceleration_radps2, "of it [rad/s^2]", 0.01, 5);
  f.Add("vertical_speed_mps", vertical_speed_mps, "of entry and exit [m/s]", 0.001, 1);
  f.Add("transfer_speed_radps", transfer_speed_radps, "of joints between strokes [rad/s]", 0.01, 2);
  f.Add("transfer_acceleration_radps2", transfer_acceleration_radps2, "of them [rad/s^2]", 0.01, 5);
  f.Add("smoothing_s", smoothing_s, "time over which accelerations are ramped [s]", 0.016, 1);
}

void Workcell::Fields(FieldList& f) {
  f.Add("name", name, "what the cell is called");
  f.Section("X_WB", X_WB);
  f.Section("box", box);
  f.Section("tool", tool);
  f.Section("limits", limits);
  f.Section("motion", motion);
  f.Section("camera", camera);
  f.Section("kinematics", kinematics);
  f.Add("home_joints_rad", home_joints_rad, "where the arm parks, base first [rad]");
  f.Add("camera_joints_rad", camera_joints_rad, "where scans are taken: six angles a pose, several poses one after another where one does not see the whole box [rad]");
  f.Section("calibration", calibration);
}

std::vector<JointAngles> Workcell::camera_poses() const {
  std::vector<JointAngles> poses;
  for (auto at = camera_joints_rad.begin(); at != camera_joints_rad.end(); at += 6)
    poses.push_back(JointAngles::FromList({at, at + 6}));
  return poses;
}

void CheckWorkcell(const Workcell& cell, const std::string& source) {
  CheckPose(cell.X_WB, source, "X_WB");
  CheckPose(cell.tool.X_FT, source, "tool.X_FT");
  CheckPose(cell.tool.X_FC, source, "tool.X_FC");
  CheckLength(cell.tool.camera_body_m, 3, source, "tool.camera_body_m");
  CheckLength(cell.tool.centre_of_mass_m, 3, source, "tool.centre_of_mass_m");
  CheckLength(cell.limits.joint_position_rad, 6, source, "limits.joint_position_rad");
  CheckLength(cell.limits.joint_speed_radps, 6, source, "limits.joint_speed_radps");
  CheckLength(cell.kinematics.a_m, 6, source, "kinematics.a_m");
  CheckLength(cell.kinematics.d_m, 6, source, "kinematics.d_m");
  CheckLength(cell.kinematics.alpha_rad, 6, source, "kinematics.alpha_rad");
  CheckLength(cell.kinematics.theta_rad, 6, source, "kinematics.theta_rad");
  CheckJoints(cell.home_joints_rad, cell.limits, source, "home_joints_rad");
  if (cell.camera_joints_rad.empty() || cell.camera_joints_rad.size() % 6 != 0)
    throw Error(fmt::format("{}: camera_joints_rad has {} numbers; six a pose are needed", source,
                            cell.camera_joints_rad.size()));
  for (const JointAngles& pose : cell.camera_poses())
    CheckJoints({pose.rad.begin(), pose.rad.end()}, cell.limits, source, "camera_joints_rad");
  CheckPendant(cell.limits, source);
  // The holder and the camera then pass over the walls wherever the blade may be.
  const double hand = cell.tool.blade_height_m + cell.limits.floor_margin_m;
  if (hand < cell.box.wall_height_m + cell.limits.clearance_m ||
      cell.tool.blade_height_m < cell.limits.max_cut_m)
    throw Error(fmt::format(
        "{}: tool.blade_height_m = {}; the plate must reach over the walls ({} m) with the "
        "clearance ({} m) and over the deepest cut ({} m)",
        source, cell.tool.blade_height_m, cell.box.wall_height_m, cell.limits.clearance_m,
        cell.limits.max_cut_m));
  const double needed = cell.box.wall_height_m + cell.limits.clearance_m;
  if (cell.motion.retreat_height_m < needed)
    throw Error(fmt::format("{}: motion.retreat_height_m = {}; the walls and the clearance need {}",
                            source, cell.motion.retreat_height_m, needed));
}

Workcell LoadWorkcell(const std::filesystem::path& file) {
  Workcell workcell;
  LoadYaml(FieldsOf(workcell), file);
  CheckWorkcell(workcell, file.string());
  return workcell;
}

std::string WorkcellHash(const Workcell& workcell) {
  Workcell cell = workcell;
  nlohmann::json content = ToJson(FieldsOf(cell));
  content.erase("calibration");
  return Sha256Hex(content.dump());
}
std::string CalibrationHash(const Workcell& workcell) { return HashOf(workcell.kinematics); }
std::string BladeHash(const Workcell& workcell) { return HashOf(workcell.tool.blade); }

}  // namespace sandwright
