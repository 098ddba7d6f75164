// The MuJoCo arm against the Denavit-Hartenberg arm.
#include "robot_model/arm_model.h"

#include <gtest/gtest.h>

#include <numbers>

#include "data/base/random.h"

namespace sandwright {
namespace {

TEST(ArmModel, FlangeAgreesWithDenavitHartenberg) {
  const Workcell cell;
  const MujocoModel model = MakeArmModel(cell);
  const MujocoData data = MakeArmData(*model);
  const Ur10 arm;
  const int flange = mj_name2id(model.get(), mjOBJ_BODY, "wrist_3_link");
  RandomStream random(5);
  double worst = 0;
  for (int sample = 0; sample < 2000; ++sample) {
    JointAngles q;
    for (double& angle : q.rad) angle = random.Uniform(-6.28, 6.28);
    SetJoints(*model, q, *data);
    const Eigen::Isometry3d X = arm.Forward(q);
    const Eigen::Map<const Eigen::Vector3d> p(data->xpos + 3 * flange);
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(data->xmat + 9 * flange);
    worst = std::max({worst, (p - X.translation()).cwiseAbs().maxCoeff(),
                      (R - X.linear()).cwiseAbs().maxCoeff()});
  }
  EXPECT_LT(worst, 1e-12);
}

TEST(ArmModel, BladeAndCameraSitWhereTheCellSays) {
  Workcell cell;
  cell.tool.X_FT = {{0.01, -0.02, 0.30}, {0, 0, 0.5}};
  cell.tool.X_FC = {{0.16, 0, 0.03}, {0.1, -0.2, 1.5}};
  const MujocoModel model = MakeArmModel(cell);
  const MujocoData data = MakeArmData(*model);
  const JointAngles q = cell.home();
  SetJoints(*model, q, *data);
  const Eigen::Isometry3d X_WF = Ur10().Forward(q);
  for (const auto& [site, pose] : {std::pair{"T", cell.tool.X_FT}, std::pair{"C", cell.tool.X_FC}})
    EXPECT_TRUE(SitePose(*model, *data, site).isApprox(X_WF * pose.ToIsometry(), 1e-12)) << site;
}

// A factory calibration with its cancelling pair: the blade is where the calibrated arm has it, and
// the links, on which the capsules sit, stay within millimetres of the nominal arm's.
TEST(ArmModel, FollowsACalibrationAndKeepsItsLinksOnTheArm) {
  Workcell cell;
  constexpr double kPi = std::numbers::pi;
  cell.kinematics.theta_rad = {1e-4, -3e-3, 2e-3, 1e-3, -4e-4, 2e-4};
  cell.kinematics.a_m = {2e-4, -0.6125, -0.5718, -1e-4, 5e-5, 1e-4};
  cell.kinematics.d_m = {0.1279, 303.1, -310.2, 7.1 + 0.163941 - 4e-4, 0.1159, 0.0919};
  cell.kinematics.alpha_rad = {kPi / 2 + 4e-4, 1e-5, -2e-5, kPi / 2 - 3e-4, -kPi / 2 + 2e-4, 1e-4};
  const MujocoModel model = MakeArmModel(cell), nominal_model = MakeArmModel(Workcell{});
  const MujocoData data = MakeArmData(*model), nominal_data = MakeArmData(*nominal_model);
  const Ur10 arm(cell.kinematics);
  RandomStream random(6);
  for (int sample = 0; sample < 500; ++sample) {
    JointAngles q;
    for (double& angle : q.rad) angle = random.Uniform(-6.28, 6.28);
    SetJoints(*model, q, *data);
    SetJoints(*nominal_model, q, *nominal_data);
    const Eigen::Isometry3d X_WT = arm.Forward(q) * cell.tool.X_FT.ToIsometry();
    EXPECT_TRUE(SitePose(*model, *data, "T").isApprox(X_WT, 1e-11));
    for (int i = 0; i < 3 * nominal_model->nbody; ++i)
      EXPECT_NEAR(data->xpos[i], nominal_data->xpos[i], 0.02);
  }
}

TEST(ArmModel, CarriesTheSandForPictures) {
  HeightMap terrain(8, 12, 0.1, 0.05f);
  terrain.At(3, 5) = 0.09f;
  const MujocoModel model = MakeArmModel(Workcell{}, &terrain);
  ASSERT_EQ(model->nhfield, 1);
  EXPECT_EQ(model->hfield_nrow[0], 8);
  EXPECT_EQ(model->hfield_ncol[0], 12);
  EXPECT_NEAR(model->hfield_size[2], 0.04, 1e-7);
  EXPECT_FLOAT_EQ(model->hfield_data[3 * 12 + 5], 1.0f);
}

TEST(ArmModel, BaseBelowTheTableIsRefused) {
  Workcell cell;
  cell.X_WB.translation_m = {-0.6, 0.3, 0.2};
  EXPECT_THROW(MakeArmModel(cell), Error);
}

}  // namespace
}  // namespace sandwright
