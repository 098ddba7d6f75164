// What the gate lets through, and the program that is made of it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <type_traits>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "robot_model/arm_program.h"

namespace sandwright {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

// Nobody but the gate makes a motion, and nothing but a motion makes a program.
static_assert(!std::is_default_constructible_v<GatedMotion>);
static_assert(!std::is_constructible_v<GatedMotion, GatedMotion::Kind, std::vector<JointAngles>>);
static_assert(!std::is_default_constructible_v<ArmProgram>);
static_assert(!std::is_constructible_v<ArmProgram, GatedMotion>);

const Stroke kStroke{{{0.55, 0.35, 0.03}, {0.65, 0.35, 0.025}, {0.65, 0.45, 0.03}}, 1, 0.1};

class Passages : public ::testing::Test {
 protected:
  Workcell cell_;
  HeightMap terrain_{80, 120, 0.01, 0.05f};
  SafetyGate gate_{cell_};
};

double LargestStep_rad(const std::vector<JointAngles>& knots) {
  double largest = 0;
  for (size_t i = 1; i < knots.size(); ++i)
    largest = std::max(largest, (knots[i].rad - knots[i - 1].rad).cwiseAbs().maxCoeff());
  return largest;
}

TEST_F(Passages, StrokeIsOneMotionFromWhereTheArmStands) {
  const Passage passage = gate_.PassStroke(kStroke, terrain_, cell_.camera_pose());
  ASSERT_TRUE(passage.motion) << ::testing::PrintToString(passage.reasons);
  const GatedMotion& motion = *passage.motion;
  EXPECT_EQ(motion.start().rad, cell_.camera_pose().rad);
  EXPECT_EQ(motion.end().rad, motion.stroke_motion().knots.back().rad);
  EXPECT_EQ(motion.knots()[motion.stroke_begin()].rad, motion.stroke_motion().knots[0].rad);
  // A knot is 8 ms on: the fastest joint may turn by 0.025 rad.
  EXPECT_LT(LargestStep_rad(motion.knots()), 0.026);
}

TEST_F(Passages, RefusedStrokeHasReasonsAndNoMotion) {
  Stroke deep = kStroke;
  deep.control_points_m[0].z() = -0.01;
  const Passage passage = gate_.PassStroke(deep, terrain_, cell_.home());
  EXPECT_FALSE(passage.motion);
  EXPECT_THAT(passage.reasons, Contains(HasSubstr("below the box floor")));
  terrain_.datum = Datum::kRelative;
  EXPECT_THAT(gate_.PassTransfer(cell_.camera_pose(), terrain_, cell_.home()).reasons,
              Contains(HasSubstr("datum is relative")));
}

TEST_F(Passages, LiftGoesStraightUp) {
  const Passage stroke = gate_.PassStroke(kStroke, terrain_, cell_.home());
  ASSERT_TRUE(stroke.motion);
  const StrokeMotion& motion = stroke.motion->stroke_motion();
  const JointAngles buried = motion.knots[(motion.path_begin + motion.path_end) / 2];
  const Passage passage = gate_.PassLift(buried);
  ASSERT_TRUE(passage.motion) << ::testing::PrintToString(passage.reasons);
  const Eigen::Isometry3d X_BT = gate_.kinematics().BladeInBox(buried);
  double z_m = X_BT.translation().z();
  for (const JointAngles& q : passage.motion->knots()) {
    const Eigen::Isometry3d X = gate_.kinematics().BladeInBox(q);
    EXPECT_LT((X.translation() - X_BT.translation()).head<2>().norm(), 1e-8);
    EXPECT_TRUE(X.linear().isApprox(X_BT.linear(), 1e-8));
    EXPECT_GE(X.translation().z(), z_m - 1e-9);
    EXPECT_LE(X.translation().z() - z_m, kLiftSpeed_mps * StrokeMotion::kPeriod_s * 1.001);
    z_m = X.translation().z();
  }
  EXPECT_NEAR(z_m, cell_.motion.retreat_height_m, 1e-9);
  EXPECT_THAT(gate_.PassLift(passage.motion->end()).reasons, Contains(HasSubstr("nothing to")));
}

TEST_F(Passages, LiftThatLeadsOutOfReachIsRefused) {
  Workcell cell = cell_;
  cell.motion.retreat_height_m = 0.999;
  cell.X_WB.translation_m[1] = 0.6;  // the box is farther away
  const SafetyGate gate(cell);
  const auto q = gate.kinematics().Solve({0.6, 0.5, 0.04, 0}, 6, false, cell.home());
  ASSERT_TRUE(q);
  EXPECT_FALSE(gate.PassLift(*q).motion);
}

// To renew the golden file after a wanted change: SANDWRIGHT_RENEW_GOLDEN=1.
TEST_F(Passages, ProgramIsTheGoldenFile) {
  const Passage passage = gate_.PassStroke(kStroke, terrain_, cell_.camera_pose());
  ASSERT_TRUE(passage.motion);
  const ArmProgram program = MakeArmProgram(*passage.motion, gate_, "stroke_7");
  const auto golden =
      std::filesystem::path(SANDWRIGHT_ROOT) / "tests/robot_model/golden/stroke_7.script";
  if (std::getenv("SANDWRIGHT_RENEW_GOLDEN")) WriteFileAtomically(golden, program.text());
  EXPECT_EQ(program.text(), ReadFile(golden));
}

TEST_F(Passages, SlowProgramIsSlowInEverything) {
  const Passage passage = gate_.PassStroke(kStroke, terrain_, cell_.camera_pose());
  ASSERT_TRUE(passage.motion);
  const ArmProgram program = MakeArmProgram(*passage.motion, gate_, "slow", 0.25);
  EXPECT_DOUBLE_EQ(program.duration_s(), 4 * passage.motion->duration_s());
  EXPECT_THAT(program.text(), HasSubstr("v=0.0250)"));         // 0.1 m/s
  EXPECT_THAT(program.text(), HasSubstr("a=0.016, v=0.0250"));  // 0.25 m/s^2
  EXPECT_THAT(program.text(), Not(HasSubstr("v=0.1000")));
  EXPECT_THROW(MakeArmProgram(*passage.motion, gate_, "7th"), Error);
}

}  // namespace
}  // namespace sandwright
