// The cell around the arm: where box, blade and camera are, and what the arm may do. One YAML file.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "data/base/config.h"
#include "data/camera.h"
#include "data/stroke.h"
#include "robot_model/calibration/record.h"
#include "robot_model/camera_source.h"
#include "robot_model/ur10.h"

namespace sandwright {

// A pose as the pendant writes it: translation and rotation vector (axis times angle).
struct PoseSetting {
  std::vector<double> translation_m = {0, 0, 0};
  std::vector<double> rotation_vector_rad = {0, 0, 0};

  void Fields(FieldList& f) {
    f.Add("translation_m", translation_m, "x, y, z [m]", -10, 10);
    f.Add("rotation_vector_rad", rotation_vector_rad, "axis times angle [rad]", -6.3, 6.3);
  }
  Eigen::Isometry3d ToIsometry() const;
  static PoseSetting FromIsometry(const Eigen::Isometry3d& X);
};

// The sand box; frame B lies in a corner of its floor, inside, x along the width.
struct BoxSettings {
  double width_m = 1.200, depth_m = 0.800;  // inside
  double wall_height_m = 0.150;             // above the box floor
  double wall_thickness_m = 0.018, floor_thickness_m = 0.018;
  double pedestal_radius_m = 0.120;  // the post from the table up to the arm's base

  void Fields(FieldList& f) {
    f.Add("width_m", width_m, "inside, along x of B [m]", 0.1, 5);
    f.Add("depth_m", depth_m, "inside, along y of B [m]", 0.1, 5);
    f.Add("wall_height_m", wall_height_m, "top of the walls above the box floor [m]", 0, 1);
    f.Add("wall_thickness_m", wall_thickness_m, "[m]", 0.001, 0.2);
    f.Add("floor_thickness_m", floor_thickness_m, "box floor above the table [m]", 0.001, 0.2);
    f.Add("pedestal_radius_m", pedestal_radius_m, "post under the arm's base [m]", 0.05, 0.5);
  }
};

// What the flange carries. The camera's body is a block around C, its long side along x of C.
struct ToolSettings {
  // T: middle of the blade's lower edge, x along its normal; C: optical frame of the camera.
  PoseSetting X_FT{{0, 0, 0.250}, {0, 0, 0}};
  PoseSetting X_FC{{0.160, 0, 0.030}, {0, 0, 1.5708}};
  Blade blade;
  double blade_height_m = 0.195;  // the plate; above it is the holder
  double holder_radius_m = 0.015;
  std::vector<double> camera_body_m = {0.250, 0.070, 0.070};
  double mass_kg = 2.2;                                 // blade, holder and camera
  std::vector<double> centre_of_mass_m = {0, 0, 0.08};  // in F

  void Fields(FieldList& f) {
    f.Section("X_FT", X_FT);
    f.Section("X_FC", X_FC);
    f.Section("blade", blade);
    f.Add("blade_height_m", blade_height_m, "height of the blade's plate [m]", 0.01, 1);
    f.Add("holder_radius_m", holder_radius_m, "rod between flange and plate [m]", 0.002, 0.1);
    f.Add("camera_body_m", camera_body_m, "extent of the camera along x, y, z of C [m]", 0.001, 1);
    f.Add("mass_kg", mass_kg, "all that the flange carries [kg]", 0, 10);
    f.Add("centre_of_mass_m", centre_of_mass_m, "of it, in F [m]", -1, 1);
  }
};

// What the arm may do. Speeds of UR10 CB3 are the manual's, times `share_of_speed`; the maker does
// not publish accelerations: 300 deg/s^2 and 2.5 m/s^2 are its staff's advice, the jerk is ours.
struct MotionLimits {
  std::vector<double> joint_position_rad = {6.2832, 6.2832, 3.1416, 6.2832, 6.2832, 6.2832};
  std::vector<double> joint_speed_radps = {2.0944, 2.0944, 3.1416, 3.1416, 3.1416, 3.1416};
  double joint_acceleration_radps2 = 5.236;
  double joint_jerk_radps3 = 100;
  double tcp_acceleration_mps2 = 2.5;
  double tcp_speed_mps = 0.25;
  double share_of_speed = 0.8, share_of_acceleration = 0.8;
  double position_margin_rad = 0.05;   // kept from the joint limits
  double min_singular_value = 0.04;    // of the flange Jacobian (m, rad)
  double clearance_m = 0.020;          // links to walls, table, sand and other links
  double wall_margin_m = 0.005;        // blade to the box walls
  double floor_margin_m = 0.002;       // blade edge above the box floor
  double max_cut_m = 0.100;            // sand above the blade's edge
  double max_extent_m = 0.255;         // of the control points along x, y and z
  double min_bend_radius_m = 0.005;    // of a curve; sharper ones are corners for a polyline
  double min_curve_speed_share = 0.2;  // to which abrupt bends may slow a curve
  double max_duration_s = 60;          // of one stroke
  double contact_force_n = 40;         // by which a stroke may exceed the same one in the air
  // What is set at the pendant, below its password. Those functions are only as true as the
  // tolerances (manual of the CB3), so that our own limits keep that much away from them.
  double pendant_tcp_speed_mps = 1.5, pendant_force_n = 100;
  static constexpr double kPendantSpeedTolerance_mps = 0.05, kPendantForceTolerance_n = 25;

  void Fields(FieldList& f);
};

// How strokes become motion.
struct MotionSettings {
  double retreat_height_m = 0.220;  // blade edge above the box floor between strokes
  double path_acceleration_mps2 = 0.25;
  double turn_speed_radps = 1.0, turn_acceleration_radps2 = 2.0;  // of the blade about its axis
  double vertical_speed_mps = 0.1;                                // entry and exit
  double transfer_speed_radps = 0.8, transfer_acceleration_radps2 = 1.4;
  double smoothing_s = 0.1;  // accelerations are ramped over this time

  void Fields(FieldList& f);
};

// What looks along z of C, and how its frames are had.
struct CellCamera : CameraModel {
  CameraSource source;

  void Fields(FieldList& f) {
    CameraModel::Fields(f);
    f.Section("source", source);
  }
};

struct Workcell {
  std::string name = "workcell";
  PoseSetting X_WB{{-0.600, 0.300, -0.180}, {0, 0, 0}};
  BoxSettings box;
  ToolSettings tool;
  MotionLimits limits;
  MotionSettings motion;
  CellCamera camera;
  DhParameters kinematics;  // nominal, or read from the controller
  std::vector<double> home_joints_rad = {-1.8476, -1.6540, 2.1158,
                                         -2.0326, -1.5708, -1.8476};  // parked
  std::vector<double> camera_joints_rad = {-1.8793, -1.7071, 1.1376,
                                           -1.0013, -1.5708, -1.8793};  // scans
  CalibrationRecords calibration;  // how kinematics, X_FC, X_FT and X_WB were measured

  void Fields(FieldList& f);
  JointAngles home() const { return JointAngles::FromList(home_joints_rad); }
  // Where scans are taken from, in that order; the first is where the arm waits between strokes.
  std::vector<JointAngles> camera_poses() const;
  JointAngles camera_pose() const { return camera_poses().front(); }
};

// Reads and checks a workcell file: lengths of lists, home and camera pose within the joint limits.
// Throws Error naming the key.
Workcell LoadWorkcell(const std::filesystem::path& file);
// The checks of LoadWorkcell on their own; `source` names where the cell came from.
void CheckWorkcell(const Workcell& workcell, const std::string& source);

// SHA-256 (hex) over the resolved content but `calibration`: it changes with any number that says
// what the arm does, and not with the day on which that was measured once more.
std::string WorkcellHash(const Workcell& workcell);
// The same over the kinematics and over the blade alone.
std::string CalibrationHash(const Workcell& workcell);
std::string BladeHash(const Workcell& workcell);

}  // namespace sandwright
