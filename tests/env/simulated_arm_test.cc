// The simulated arm follows a stroke as closely as it says, the same way for the same seed.
#include "env/simulated_arm.h"

#include <gtest/gtest.h>

#include "data/base/error.h"
#include "env/arm_picture.h"
#include "robot_model/safety_gate.h"
#include "tests/support/random_strokes.h"

namespace sandwright {
namespace {

class Arm : public ::testing::Test {
 protected:
  ToolPath PathOf(const SimulatedArm& arm, RandomStream& random) const {
    return ExecutedPath(arm.Follow(motion_.knots, random), motion_, motion_.knots,
                        [&](const JointAngles& q) { return arm.BladeInBox(q); });
  }

  Workcell cell_;
  HeightMap terrain_{80, 120, 0.01, 0.05f};
  Stroke stroke_ = TypicalStroke(0.6, 0.4, 0.0);
  StrokeMotion motion_ = *SafetyGate(cell_).Check(stroke_, terrain_, GateSampling::kFine).motion;
};

TEST_F(Arm, PerfectServoTracesTheStroke) {
  const SimulatedArm arm(cell_, {.servo_lag_s = 0, .wander_rad = 0});
  RandomStream random(1);
  const ToolPath path = PathOf(arm, random);
  EXPECT_NEAR(path.front().x_m, 0.54, 1e-9);
  EXPECT_NEAR(path.back().x_m, 0.66, 1e-9);
  for (const BladePose& pose : path) {
    EXPECT_NEAR(pose.y_m, 0.4, 1e-6);
    EXPECT_NEAR(pose.z_m, 0.02, 1e-6);
    EXPECT_NEAR(pose.yaw_rad, 0, 1e-6);
  }
  for (size_t i = 1; i < path.size(); ++i)
    EXPECT_LT(path[i].x_m - path[i - 1].x_m, 2e-3);
}

TEST_F(Arm, DefaultsStrayByAboutATenthOfAMillimetre) {
  const SimulatedArm arm(cell_);
  double worst = 0;
  for (uint64_t seed = 0; seed < 10; ++seed) {
    RandomStream random(seed);
    for (const BladePose& pose : PathOf(arm, random))
      worst = std::max({worst, std::abs(pose.y_m - 0.4), std::abs(pose.z_m - 0.02)});
  }
  EXPECT_GT(worst, 0.02e-3);
  EXPECT_LT(worst, 0.5e-3);
}

TEST_F(Arm, SameSeedSameBytesOtherSeedOther) {
  const SimulatedArm arm(cell_);
  RandomStream a(1), b(1), c(2);
  const ToolPath first = PathOf(arm, a), second = PathOf(arm, b), third = PathOf(arm, c);
  ASSERT_EQ(first.size(), second.size());
  for (size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].y_m, second[i].y_m);
  EXPECT_NE(first[5].y_m, third[5].y_m);
}

TEST_F(Arm, RecordCoversTheMotionAndComesToRest) {
  const SimulatedArm arm(cell_);
  RandomStream random(3);
  const ArmRecord record = arm.Follow(motion_.knots, random);
  EXPECT_GT(record.size(), motion_.knots.size());
  EXPECT_EQ(record.commanded.size(), record.size());
  EXPECT_EQ(record.speed_radps.size(), record.size());
  EXPECT_LT((record.measured.back().rad - motion_.knots.back().rad).norm(), 1e-3);
  EXPECT_NEAR(record.time_s[1], 0.008, 1e-12);
}

TEST_F(Arm, HalfTheSpeedTakesTwiceTheTime) {
  const SimulatedArm arm(cell_, {.servo_lag_s = 0, .wander_rad = 0});
  RandomStream random(3);
  const ArmRecord full = arm.Follow(motion_.knots, random),
                  half = arm.Follow(motion_.knots, random, 0.5);
  EXPECT_EQ(half.size(), 2 * full.size() - 1);
  for (size_t i = 0; i < full.size(); ++i)
    EXPECT_EQ(half.measured[2 * i].rad, full.measured[i].rad);
}

TEST_F(Arm, PictureShowsSandAndArmWhereTheMachineCanDraw) {
  try {
    ArmPicture picture(cell_, terrain_, 320, 240);
    const cv::Mat home = picture.Draw(cell_.home()),
                  moved = picture.Draw(motion_.knots[motion_.path_begin]);
    ASSERT_EQ(home.rows, 240);
    ASSERT_EQ(home.cols, 320);
    EXPECT_GT(cv::norm(home, moved, cv::NORM_L1), 1e4);  // the arm is seen to move
    const cv::Vec3b sand = home.at<cv::Vec3b>(180, 160);
    EXPECT_GT(sand[2], sand[0]);  // BGR: sand is yellow
  } catch (const Error& error) {
    GTEST_SKIP() << error.what();
  }
}

}  // namespace
}  // namespace sandwright
