// The workcell file: round trip, identity, and what is refused.
#include "robot_model/workcell.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "data/base/error.h"
#include "robot_model/workcell_picture.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path kRoot = SANDWRIGHT_ROOT;

std::string LoadError(const std::string& yaml) {
  std::ofstream("cell.yaml") << yaml;
  try {
    LoadWorkcell("cell.yaml");
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Workcell, ShippedFilesLoadAndNameEveryKey) {
  for (const char* file : {"configs/workcell.yaml", "configs/workcell_small.yaml"}) {
    Workcell cell = LoadWorkcell(kRoot / file);
    std::ofstream("again.yaml") << ToYaml(FieldsOf(cell));
    EXPECT_EQ(WorkcellHash(LoadWorkcell("again.yaml")), WorkcellHash(cell)) << file;
    EXPECT_EQ(CalibrationHash(cell), CalibrationHash(Workcell{}));
  }
  EXPECT_DOUBLE_EQ(LoadWorkcell(kRoot / "configs/workcell_small.yaml").box.width_m, 0.3);
}

TEST(Workcell, HashesFollowTheirContent) {
  Workcell cell, other;
  EXPECT_EQ(WorkcellHash(cell).size(), 64u);
  other.tool.blade.width_m += 1e-9;
  EXPECT_NE(WorkcellHash(cell), WorkcellHash(other));
  EXPECT_NE(BladeHash(cell), BladeHash(other));
  EXPECT_EQ(CalibrationHash(cell), CalibrationHash(other));
  other.kinematics.d_m[5] += 1e-6;
  EXPECT_NE(CalibrationHash(cell), CalibrationHash(other));
}

TEST(Workcell, CameraSeesTheWholeBoxAndNotTheBlade) {
  for (const char* file : {"configs/workcell.yaml", "configs/workcell_small.yaml"}) {
    const Workcell cell = LoadWorkcell(kRoot / file);
    const Eigen::Isometry3d X_WF = Ur10(cell.kinematics).Forward(cell.camera_pose());
    const Eigen::Isometry3d X_CW = (X_WF * cell.tool.X_FC.ToIsometry()).inverse();
    const auto in_view = [&](const Eigen::Vector3d& p_C) {
      const double u = cell.camera.fx_px * p_C.x() / p_C.z() + cell.camera.cx_px;
      const double v = cell.camera.fy_px * p_C.y() / p_C.z() + cell.camera.cy_px;
      return p_C.z() > 0 && u > 0 && u < static_cast<double>(cell.camera.width) && v > 0 &&
             v < static_cast<double>(cell.camera.height);
    };
    for (const double x : {0.0, cell.box.width_m})
      for (const double y : {0.0, cell.box.depth_m})
        for (const double z : {0.0, cell.box.wall_height_m})
          EXPECT_TRUE(in_view(X_CW * cell.X_WB.ToIsometry() * Eigen::Vector3d(x, y, z)))
              << file << x << y << z;
    EXPECT_FALSE(in_view(X_CW * X_WF * cell.tool.X_FT.ToIsometry() * Eigen::Vector3d(0, 0, 0)))
        << file;
  }
}

TEST(Workcell, BadFilesNameTheKey) {
  EXPECT_THAT(LoadError("X_WB: {translation_m: [0, 0]}"),
              HasSubstr("X_WB.translation_m has 2 numbers; 3"));
  EXPECT_THAT(LoadError("home_joints_rad: [0, 0, 0]"),
              HasSubstr("home_joints_rad has 3 numbers; 6"));
  EXPECT_THAT(LoadError("home_joints_rad: [0, 0, 3.2, 0, 0, 0]"),
              HasSubstr("home_joints_rad: joint 3"));
  EXPECT_THAT(LoadError("box: {widht_m: 1}"), HasSubstr("did you mean 'box.width_m'?"));
  EXPECT_THAT(LoadError("limits: {joint_acceleration_radps2: 9}"),
              HasSubstr("allowed: 0.1..5.236"));
  EXPECT_THAT(LoadError("motion: {retreat_height_m: 0.1}"),
              HasSubstr("motion.retreat_height_m = 0.1"));
  EXPECT_THAT(LoadError("tool: {blade_height_m: 0.1}"), HasSubstr("tool.blade_height_m = 0.1"));
  EXPECT_THAT(LoadError("limits: {pendant_tcp_speed_mps: 0.29}"),
              HasSubstr("limits.tcp_speed_mps = 0.25; allowed: up to 0.24 m/s"));
  EXPECT_THAT(LoadError("limits: {contact_force_n: 76}"),
              HasSubstr("limits.contact_force_n = 76; allowed: up to 75 N"));
}

TEST(Workcell, PoseSettingIsTheRotationVectorOfThePendant) {
  const PoseSetting pose{{1, 2, 3}, {0, 0, std::numbers::pi / 2}};
  const Eigen::Vector3d p = pose.ToIsometry() * Eigen::Vector3d(1, 0, 0);
  EXPECT_TRUE(p.isApprox(Eigen::Vector3d(1, 3, 3), 1e-12)) << p.transpose();
  EXPECT_TRUE(PoseSetting{}.ToIsometry().isApprox(Eigen::Isometry3d::Identity()));
}

TEST(Workcell, CameraPosesAddUpInWhatTheySee) {
  Workcell cell;
  EXPECT_DOUBLE_EQ(CameraCoverage(cell), 1);
  cell.camera.width = 300;
  cell.camera.cx_px = 150;
  const double one = CameraCoverage(cell);
  EXPECT_LT(one, 0.9);
  std::vector<double> aside = cell.camera_joints_rad;
  aside[0] += 0.4;
  cell.camera_joints_rad.insert(cell.camera_joints_rad.end(), aside.begin(), aside.end());
  CheckWorkcell(cell, "cell");
  EXPECT_EQ(cell.camera_poses().size(), 2u);
  EXPECT_GT(CameraCoverage(cell), one + 0.05);
  cell.camera_joints_rad.pop_back();
  EXPECT_THROW(CheckWorkcell(cell, "cell"), Error);
}

}  // namespace
}  // namespace sandwright
