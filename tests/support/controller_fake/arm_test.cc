// The fake's arm: speed limits, profiles, blends, slider, pauses and stops.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/controller_fake/offline_run.h"

namespace sandwright::fake {
namespace {

struct Extremes {
  Vector6 speed_radps = Vector6::Zero();
  double acceleration_radps2 = 0;
};

Extremes Measure(const std::vector<TracePoint>& trace) {
  Extremes extremes;
  Vector6 last = Vector6::Zero();
  for (size_t i = 1; i < trace.size(); ++i) {
    const Vector6 speed = (trace[i].q.rad - trace[i - 1].q.rad) / kControlPeriod_s;
    extremes.speed_radps = extremes.speed_radps.cwiseMax(speed.cwiseAbs());
    const double acceleration = (speed - last).cwiseAbs().maxCoeff() / kControlPeriod_s;
    extremes.acceleration_radps2 = std::max(extremes.acceleration_radps2, acceleration);
    last = speed;
  }
  return extremes;
}

class Arm : public ::testing::Test {
 protected:
  ControllerCore core_{ControllerFakeOptions{}};
};

TEST_F(Arm, KeepsTheJointsLimitsWhateverIsAskedFor) {
  ASSERT_TRUE(RunToEnd(core_,
                       "def fast():\n"
                       "  movej([1, -0.5, 0.5, 2, 2, 3], a=100, v=20)\n"
                       "  movej([-1.8, -1.65, 2.1, -2, -1.57, -1.85], a=30, v=3.1)\n"
                       "  movel(p[0.3, 0.6, 0.1, 0, 3.14159, 0], a=20, v=5)\n"
                       "  speedj([5, 5, 0, 0, 0, 9], a=35, t=0.3)\n"
                       "  stopj(30)\n"
                       "end\n"));
  EXPECT_FALSE(core_.last_fault()) << core_.last_fault()->text;
  const Extremes extremes = Measure(core_.trace());
  for (int i = 0; i < 6; ++i) {
    EXPECT_LE(extremes.speed_radps[i], kJointSpeedLimit_radps[i] * 1.0001) << i;
  }
  EXPECT_GT(extremes.speed_radps[0], 2.09);
}

TEST_F(Arm, MoveInTheJointsIsATrapezoid) {
  ASSERT_TRUE(RunToEnd(core_,
                       "def one():\n"
                       "  q = get_actual_joint_positions()\n"
                       "  movej([q[0] + 1, q[1], q[2], q[3], q[4], q[5]], a=1.4, v=0.8)\n"
                       "end\n"));
  const Extremes extremes = Measure(core_.trace());
  EXPECT_NEAR(extremes.speed_radps[0], 0.8, 1e-9);
  EXPECT_NEAR(extremes.acceleration_radps2, 1.4, 1e-6);
  EXPECT_NEAR(core_.state().q[0], -1.8476 + 1, 1e-12);
  EXPECT_NEAR(static_cast<double>(core_.trace().size()) * kControlPeriod_s, 1 / 0.8 + 0.8 / 1.4,
              0.03);
}

TEST_F(Arm, TimedMoveTakesItsTime) {
  ASSERT_TRUE(RunToEnd(core_, "def one():\n  movej([0, -1.5, 1.5, 0, 0, 0], t=3)\nend\n"));
  EXPECT_NEAR(static_cast<double>(core_.trace().size()) * kControlPeriod_s, 3, 0.03);
}

TEST_F(Arm, BlendPassesTheCornerWithinItsRadius) {
  ASSERT_TRUE(RunToEnd(core_,
                       "def corner():\n"
                       "  movel(p[0, 0.6, 0, 0, 3.14159, 0], v=0.2)\n"
                       "  write_output_integer_register(0, 1)\n"
                       "  movep(p[0.1, 0.6, 0, 0, 3.14159, 0], a=1, v=0.1, r=0.02)\n"
                       "  movel(p[0.1, 0.7, 0, 0, 3.14159, 0], a=1, v=0.1)\n"
                       "end\n"));
  EXPECT_FALSE(core_.last_fault());
  const Eigen::Vector3d corner(0.1, 0.6, 0);
  double nearest = 1, slowest = 1;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  for (const TracePoint& point : core_.trace()) {
    const Eigen::Vector3d at =
        (core_.arm().kinematics().Forward(point.q) * core_.arm().tcp()).translation();
    nearest = std::min(nearest, (at - corner).norm());
    if (point.segment == 1 && (at - corner).norm() < 0.04)
      slowest = std::min(slowest, (at - last).norm() / kControlPeriod_s);
    last = at;
  }
  EXPECT_GT(nearest, 0.002);
  EXPECT_LT(nearest, 0.02);
  EXPECT_GT(slowest, 0.07);  // it does not stop
}

TEST_F(Arm, SliderStretchesTime) {
  core_.SetSlider(0.3);
  ASSERT_TRUE(RunToEnd(core_, "def one():\n  movej([0, -1.5, 1.5, 0, 0, 0], t=3)\nend\n"));
  EXPECT_NEAR(static_cast<double>(core_.trace().size()) * kControlPeriod_s, 10, 0.05);
  EXPECT_EQ(core_.state().speed_slider, 0.3);
  EXPECT_EQ(core_.state().speed_scaling, 1);
}

TEST_F(Arm, StopsComeToRestOnThePathAndGoOnThere) {
  core_.Upload("def one():\n  movel(p[0, 0.6, 0, 0, 3.14159, 0], v=0.2)\n  sleep(1)\n"
               "  movel(p[0.3, 0.6, 0, 0, 3.14159, 0], v=0.2)\nend\n");
  while (core_.state().X_WT.translation().x() < 0.1) core_.Tick();
  const auto rest = [&] {
    for (int i = 0; i < 100; ++i) core_.Tick();
    EXPECT_EQ(core_.state().runtime, RuntimeState::kPaused);
    EXPECT_EQ(core_.state().qd_radps.norm(), 0);
    EXPECT_NEAR(core_.state().X_WT.translation().y(), 0.6, 1e-6);
  };
  core_.Pause();
  rest();
  EXPECT_TRUE(core_.Play());
  for (int i = 0; i < 30; ++i) core_.Tick();
  core_.SafeguardStop(true);
  rest();
  EXPECT_EQ(core_.state().safety_mode, SafetyMode::kSafeguardStop);
  core_.SafeguardStop(false);  // it goes on by itself
  for (int i = 0; i < 30; ++i) core_.Tick();
  EXPECT_GT(core_.state().qd_radps.norm(), 0);
  core_.ProtectiveStop("test");
  rest();
  EXPECT_FALSE(core_.Play());
  EXPECT_TRUE(core_.UnlockProtectiveStop());
  EXPECT_EQ(core_.state().runtime, RuntimeState::kPaused);
  EXPECT_TRUE(core_.Play());
  while (core_.ProgramRunning()) core_.Tick();
  EXPECT_NEAR(core_.state().X_WT.translation().x(), 0.3, 1e-9);
}

TEST_F(Arm, EmergencyStopEndsTheProgramAndTakesThePower) {
  core_.Upload("def one():\n  movej([0, -1.5, 1.5, 0, 0, 0])\nend\n");
  for (int i = 0; i < 50; ++i) core_.Tick();
  core_.EmergencyStop(true);
  for (int i = 0; i < 100; ++i) core_.Tick();
  EXPECT_EQ(core_.state().robot_mode, RobotMode::kPowerOff);
  EXPECT_EQ(core_.state().runtime, RuntimeState::kStopped);
  EXPECT_FALSE(core_.PowerOn());
  core_.EmergencyStop(false);
  EXPECT_TRUE(core_.PowerOn());
  for (int i = 0; i < 200; ++i) core_.Tick();
  EXPECT_EQ(core_.state().robot_mode, RobotMode::kIdle);
  EXPECT_TRUE(core_.BrakeRelease());
  for (int i = 0; i < 100; ++i) core_.Tick();
  EXPECT_EQ(core_.state().robot_mode, RobotMode::kRunning);
}

}  // namespace
}  // namespace sandwright::fake
