// Kinematics of the UR10: golden vectors, and inverse against forward.
#include "robot_model/ur10.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "data/base/random.h"

namespace sandwright {
namespace {

constexpr double kPi = std::numbers::pi;

JointAngles Joints(std::initializer_list<double> list) {
  return JointAngles::FromList(std::vector<double>(list));
}

JointAngles RandomJoints(RandomStream& random, double range) {
  JointAngles q;
  for (double& angle : q.rad) angle = random.Uniform(-range, range);
  return q;
}

double Distance(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

// Distance of two joint vectors, whole turns apart counting as the same.
double JointDistance(const JointAngles& a, const JointAngles& b) {
  return (NearestTurns(a, b).rad - b.rad).cwiseAbs().maxCoeff();
}

// The simulated arm that produced the golden vectors rounds pi/2 to 1.570796327.
Ur10 GoldenArm() {
  DhParameters dh;
  dh.alpha_rad = {1.570796327, 0, 0, 1.570796327, -1.570796327, 0};
  return Ur10(dh);
}

TEST(Ur10, ForwardGivesTheGoldenVectors) {
  const Ur10 arm = GoldenArm();
  const auto first =
      arm.Forward(Joints({-1.6007002035724085, -1.7271001974688929, -2.2029998938189905,
                          -0.8079999128924769, 1.5951000452041626, -0.03099996248354131}));
  EXPECT_NEAR(first.translation().x(), -0.179925914147547, 1e-12);
  EXPECT_NEAR(first.translation().y(), -0.606869755162764, 1e-12);
  EXPECT_NEAR(first.translation().z(), 0.230789102067257, 1e-12);
  const auto second =
      arm.Forward(Joints({1.326450228691101, 2.4260077476501465, 5.951572895050049,
                          1.2740904092788696, -0.5410521666156214, 0.12217304855585098}));
  EXPECT_NEAR(second.translation().x(), 0.399229880032804, 1e-12);
  EXPECT_NEAR(second.translation().y(), 0.596883650693405, 1e-12);
  EXPECT_NEAR(second.translation().z(), -0.667781904027638, 1e-12);
  const auto zero = Ur10().Forward(JointAngles{});
  EXPECT_NEAR(zero.translation().x(), -1.1843, 1e-15);
  EXPECT_NEAR(zero.translation().y(), -0.256141, 1e-15);
  EXPECT_NEAR(zero.translation().z(), 0.0116, 1e-15);
}

TEST(Ur10, JacobianIsTheDerivativeOfForward) {
  const Ur10 arm;
  RandomStream random(11);
  for (int sample = 0; sample < 20; ++sample) {
    const JointAngles q = RandomJoints(random, kPi);
    const Matrix6 J = arm.Jacobian(q);
    for (int i = 0; i < 6; ++i) {
      constexpr double kStep = 1e-6;
      JointAngles up = q, down = q;
      up.rad[i] += kStep;
      down.rad[i] -= kStep;
      const auto X_up = arm.Forward(up), X_down = arm.Forward(down);
      const Eigen::Vector3d v = (X_up.translation() - X_down.translation()) / (2 * kStep);
      const Eigen::Matrix3d W =
          (X_up.linear() - X_down.linear()) / (2 * kStep) * arm.Forward(q).linear().transpose();
      EXPECT_LT((v - J.col(i).head<3>()).norm(), 1e-8);
      EXPECT_LT((Eigen::Vector3d(W(2, 1), W(0, 2), W(1, 0)) - J.col(i).tail<3>()).norm(), 1e-8);
    }
  }
}

TEST(Ur10, InverseReachesTenThousandPosesToANanometre) {
  const Ur10 arm;
  RandomStream random(1);
  int original_missed = 0, away = 0;
  for (int sample = 0; sample < 10000; ++sample) {
    const JointAngles q = RandomJoints(random, 2 * kPi);
    const Eigen::Isometry3d X = arm.Forward(q);
    const auto solutions = arm.Inverse(X);
    ASSERT_GE(solutions.size(), 2u);
    bool found = false, near_singular = false;
    for (const IkSolution& solution : solutions) {
      near_singular |= solution.near_singular;
      const double error = Distance(arm.Forward(solution.q), X);
      ASSERT_LT(error, solution.near_singular ? 1e-6 : 1e-9) << "sample " << sample;
      EXPECT_LE(solution.q.rad.cwiseAbs().maxCoeff(), kPi);
      found |= JointDistance(solution.q, q) < 1e-6;
    }
    away += !near_singular;
    original_missed += !found && !near_singular;
  }
  EXPECT_GT(away, 9900);
  EXPECT_EQ(original_missed, 0);
}

TEST(Ur10, InverseReachesTheGridOfRightAngles) {
  const Ur10 arm;
  double worst = 0;
  for (int code = 0; code < 15625; ++code) {  // 5^6
    JointAngles q;
    int rest = code;
    for (double& angle : q.rad) angle = (rest % 5 - 2) * kPi / 2, rest /= 5;
    const Eigen::Isometry3d X = arm.Forward(q);
    const auto solutions = arm.Inverse(X, q[5]);
    ASSERT_FALSE(solutions.empty()) << q.rad.transpose();
    // Away from singularities every solution; on them, where branches meet, the best.
    double best = 1;
    for (const IkSolution& solution : solutions) {
      const double error = Distance(arm.Forward(solution.q), X);
      best = std::min(best, error);
      if (!solution.near_singular) {
        EXPECT_LT(error, 1e-9) << q.rad.transpose();
      }
    }
    worst = std::max(worst, best);
  }
  EXPECT_LT(worst, 1e-7);
}

TEST(Ur10, BranchesAreDistinctAndNamedConsistently) {
  const Ur10 arm;
  const auto X = arm.Forward(Joints({-1.8, -1.0, 1.7, -2.2, -1.4, 0.3}));
  const auto solutions = arm.Inverse(X);
  ASSERT_EQ(solutions.size(), 8u);
  for (size_t i = 0; i < 8; ++i) {
    const IkSolution& s = solutions[i];
    EXPECT_EQ(s.branch, static_cast<Branch>(i));
    EXPECT_EQ(s.q[2] < 0, (s.branch & 1) != 0);
    EXPECT_EQ(s.q[4] < 0, (s.branch & 2) != 0);
    EXPECT_LT(JointDistance(arm.Inverse(X, s.branch)->q, s.q), 1e-15);
    for (size_t j = 0; j < i; ++j) EXPECT_GT(JointDistance(s.q, solutions[j].q), 0.1);
  }
}

TEST(Ur10, FreeJoint6IsSetAsAsked) {
  const Ur10 arm;
  const auto X = arm.Forward(Joints({0.3, -1.0, 1.2, -0.5, 0.0, 0.9}));
  const auto solutions = arm.Inverse(X, 0.25);
  ASSERT_FALSE(solutions.empty());
  EXPECT_LE(solutions.size(), 6u);
  bool some_free = false;
  for (const auto& s : solutions) {
    if (!s.joint6_free) continue;
    some_free = true;
    EXPECT_TRUE(s.near_singular);
    EXPECT_NEAR(s.q[5], 0.25, 1e-6);
    EXPECT_LT(Distance(arm.Forward(s.q), X), 1e-7);
  }
  EXPECT_TRUE(some_free);
}

TEST(Ur10, OutOfReachHasNoSolution) {
  const Ur10 arm;
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() << 1.5, 0, 0.2;
  EXPECT_TRUE(arm.Inverse(X).empty());
  X.translation() << 0.02, 0.01, 0.2;  // inside the cylinder around the base axis
  EXPECT_TRUE(arm.Inverse(X).empty());
}

TEST(Ur10, CalibratedParametersArePolishedToANanometre) {
  DhParameters dh;  // deltas of a factory calibration's size, with its cancelling pair in d2, d3
  dh.theta_rad = {1e-4, -3e-3, 2e-3, 1e-3, -4e-4, 0};
  dh.a_m = {2e-4, -0.6125, -0.5718, -1e-4, 5e-5, 0};
  dh.d_m = {0.1279, 303.1, -310.2, 7.1 + 0.163941 - 4e-4, 0.1159, 0.0919};
  dh.alpha_rad = {kPi / 2 + 4e-4, 1e-5, -2e-5, kPi / 2 - 3e-4, -kPi / 2 + 2e-4, 0};
  const Ur10 arm(dh);
  RandomStream random(3);
  int reached = 0, poses = 0;
  for (int sample = 0; sample < 500; ++sample) {
    const JointAngles q = RandomJoints(random, kPi);
    // Well inside the branches: a millimetre of calibration can close one near its edge.
    if (std::abs(std::sin(q[4])) < 0.2 || std::abs(std::sin(q[2])) < 0.2) continue;
    const auto X = arm.Forward(q);
    if (std::hypot(X.translation().x(), X.translation().y()) < 0.4) continue;
    ++poses;
    double best = 1;
    for (const auto& s : arm.Inverse(X)) best = std::min(best, Distance(arm.Forward(s.q), X));
    reached += best < 1e-9;
  }
  EXPECT_EQ(reached, poses);
  EXPECT_GT(poses, 200);
}

TEST(Ur10, SmallestSingularValueVanishesAtSingularities) {
  const Ur10 arm;
  EXPECT_LT(SmallestSingularValue(arm.Jacobian(Joints({0.2, -1, 0, 0.3, 1, 0}))),
            1e-7);  // stretched
  EXPECT_LT(SmallestSingularValue(arm.Jacobian(Joints({0.2, -1, 1, 0.3, 0, 0}))), 1e-7);  // wrist
  EXPECT_GT(SmallestSingularValue(arm.Jacobian(Joints({-1.8, -1.1, 1.7, -2.2, -1.57, 0}))), 0.1);
}

}  // namespace
}  // namespace sandwright
