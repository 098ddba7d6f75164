// The gate: what it accepts, and each reason for which it refuses.
#include "robot_model/safety_gate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "data/base/parallel.h"
#include "tests/support/random_strokes.h"

namespace sandwright {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class Gate : public ::testing::Test {
 protected:
  HeightMap terrain_{80, 120, 0.01, 0.05f};
  SafetyGate gate_{Workcell{}};

  // Both samplings refuse, and the fine one says why.
  void ExpectRefused(const Stroke& stroke, const std::string& reason) {
    EXPECT_FALSE(gate_.Check(stroke, terrain_, GateSampling::kCoarse).accepted) << reason;
    const GateVerdict verdict = gate_.Check(stroke, terrain_, GateSampling::kFine);
    EXPECT_FALSE(verdict.accepted);
    EXPECT_FALSE(verdict.motion.has_value());
    EXPECT_THAT(verdict.reasons, Contains(HasSubstr(reason)));
  }
  static Stroke Line(Eigen::Vector3d a, Eigen::Vector3d b) { return {{a, b}, 1, 0.1}; }
};

TEST_F(Gate, AcceptsATypicalStrokeWithItsFigures) {
  const Stroke stroke = TypicalStroke(0.6, 0.4, 0.3);
  const GateVerdict coarse = gate_.Check(stroke, terrain_, GateSampling::kCoarse);
  EXPECT_TRUE(coarse.accepted) << ::testing::PrintToString(coarse.reasons);
  EXPECT_FALSE(coarse.motion.has_value());
  const GateVerdict fine = gate_.Check(stroke, terrain_, GateSampling::kFine);
  ASSERT_TRUE(fine.accepted) << ::testing::PrintToString(fine.reasons);
  EXPECT_TRUE(fine.reasons.empty());
  // 0.2 m down and up at 0.1 m/s, 0.12 m of path: 5.2 s, three ramps
  // of 0.4 s and smoothings of 0.1 s.
  EXPECT_NEAR(fine.duration_s, 5.2 + 3 * 0.5, 0.05);
  EXPECT_NEAR(coarse.duration_s, fine.duration_s, 0.05);
  EXPECT_GT(fine.peak_joint_speed_share, 0.05);
  EXPECT_LT(fine.peak_joint_speed_share, 0.5);
  EXPECT_GT(fine.min_clearance_m, 0.02);
  EXPECT_GT(fine.min_singular_value, 0.1);
  EXPECT_GE(fine.branch, 0);
  EXPECT_NEAR(fine.motion->duration_s(), fine.duration_s, 1e-9);
}

TEST_F(Gate, RefusesBadShapes) {
  ExpectRefused({{{0.6, 0.4, 0.03}}, 1, 0.1}, "1 points");
  ExpectRefused({std::vector<Eigen::Vector3d>(5, {0.6, 0.4, 0.03}), 1, 0.1}, "5 points");
  ExpectRefused(Line({0.6, 0.4, 0.03}, {0.6, 0.4, 0.03}), "apart in the plane");
  ExpectRefused(Line({0.6, kNan, 0.03}, {0.7, 0.4, 0.03}), "must be finite");
  ExpectRefused(Line({0.4, 0.4, 0.03}, {0.66, 0.4, 0.03}),
                "control points span 0.260 m along x; limit 0.255 m");
  ExpectRefused({{{0.6, 0.4, 0.03}, {0.7, 0.4, 0.03}}, 1, 0.3}, "speed 0.300 m/s; limit 0.200 m/s");
  ExpectRefused({{{0.4, 0.3, 0.03}, {0.6, 0.3001, 0.03}, {0.4, 0.3002, 0.03}}, 2, 0.1},
                "curve bends with a radius");
}

TEST_F(Gate, KeepsTheWholeBladeInsideTheWalls) {
  // Across the path the blade is 50 mm wide: 25 mm and the 5 mm margin from the wall is the limit.
  EXPECT_TRUE(
      gate_.Check(Line({0.3, 0.0301, 0.03}, {0.4, 0.0301, 0.03}), terrain_, GateSampling::kFine)
          .accepted);
  ExpectRefused(Line({0.3, 0.0299, 0.03}, {0.4, 0.0299, 0.03}), "4.9 mm inside the box wall");
  // Along the path it is 5 mm thick.
  EXPECT_TRUE(
      gate_.Check(Line({0.0076, 0.3, 0.03}, {0.1, 0.3, 0.03}), terrain_, GateSampling::kFine)
          .accepted);
  ExpectRefused(Line({0.0074, 0.3, 0.03}, {0.1, 0.3, 0.03}), "mm inside the box wall");
  ExpectRefused(Line({1.15, 0.3, 0.03}, {1.25, 0.3, 0.03}), "beyond the box wall");
}

TEST_F(Gate, KeepsOffTheFloorAndOutOfDeepSand) {
  ExpectRefused(Line({0.6, 0.4, -0.004}, {0.7, 0.4, 0.03}), "4.0 mm below the box floor");
  ExpectRefused(Line({0.6, 0.4, 0.001}, {0.7, 0.4, 0.03}), "1.0 mm above the box floor");
  const Stroke stroke = Line({0.6, 0.4, 0.03}, {0.7, 0.4, 0.03});
  EXPECT_TRUE(gate_.Check(stroke, terrain_, GateSampling::kFine).accepted);
  for (int row = 38; row < 42; ++row)
    for (int column = 60; column < 70; ++column) terrain_.At(row, column) = 0.14f;
  ExpectRefused(stroke, "110.0 mm deep in the sand");
}

TEST_F(Gate, RefusesTerrainsItCannotTrust) {
  const Stroke stroke = TypicalStroke(0.6, 0.4, 0.3);
  terrain_.datum = Datum::kRelative;
  ExpectRefused(stroke, "datum is relative");
  terrain_ = HeightMap(30, 30, 0.01, 0.05f);
  ExpectRefused(stroke, "0.300 x 0.300 m; the box of the workcell is 1.200 x 0.800 m");
  terrain_ = HeightMap(80, 120, 0.01, 0.05f);
  terrain_.At(40, 60) = std::numeric_limits<float>::quiet_NaN();
  ExpectRefused(stroke, "height under the blade is not finite");
}

TEST_F(Gate, RefusesWhatTheArmCannotReachOrMustNotTouch) {
  Workcell far;
  far.X_WB.translation_m = {-0.6, 0.9, -0.18};
  const SafetyGate far_gate(far);
  const auto verdict = far_gate.Check(TypicalStroke(1.0, 0.7, 0.3), terrain_, GateSampling::kFine);
  EXPECT_THAT(verdict.reasons, Contains(HasSubstr("out of reach")));
  EXPECT_EQ(verdict.branch, -1);

  Workcell tight;
  tight.limits.clearance_m = 0.09;  // more than the camera ever has to the forearm
  tight.motion.retreat_height_m = 0.25;
  tight.tool.blade_height_m = 0.245;
  const auto close =
      SafetyGate(tight).Check(TypicalStroke(0.6, 0.4, 0.3), terrain_, GateSampling::kFine);
  EXPECT_THAT(close.reasons, Contains(HasSubstr("come within")));

  Workcell slow;
  slow.limits.joint_speed_radps = {0.1, 0.1, 0.1, 0.1, 0.1, 0.1};
  slow.limits.joint_acceleration_radps2 = 0.3;
  const auto fast =
      SafetyGate(slow).Check(TypicalStroke(0.6, 0.4, 0.3), terrain_, GateSampling::kFine);
  EXPECT_THAT(fast.reasons, Contains(HasSubstr("speed")));
  EXPECT_THAT(fast.reasons, Contains(HasSubstr("acceleration")));

  Workcell hurried;
  hurried.limits.max_duration_s = 5;
  const auto late =
      SafetyGate(hurried).Check(TypicalStroke(0.6, 0.4, 0.3), terrain_, GateSampling::kFine);
  EXPECT_THAT(late.reasons, Contains(HasSubstr("limit 5.0 s")));
}

TEST_F(Gate, NeedsDistanceFromSingularities) {
  Workcell cell;
  cell.limits.min_singular_value = 0.5;
  const auto verdict =
      SafetyGate(cell).Check(TypicalStroke(0.6, 0.4, 0.3), terrain_, GateSampling::kFine);
  EXPECT_THAT(verdict.reasons, Contains(HasSubstr("near a singularity")));
}

TEST_F(Gate, GivesEveryReason) {
  const auto verdict =
      gate_.Check({{{-0.01, 0.4, -0.01}, {0.3, 0.4, 0.03}}, 1, 0.5}, terrain_, GateSampling::kFine);
  EXPECT_GE(verdict.reasons.size(), 4u) << ::testing::PrintToString(verdict.reasons);
}

TEST_F(Gate, WhatTheCoarseSamplingAcceptsTheFineOneAccepts) {
  RandomStream random(21);
  int coarse = 0, fine = 0;
  for (int sample = 0; sample < 400; ++sample) {
    const Stroke stroke = RandomStroke(1.2, 0.8, random);
    const bool is_coarse = gate_.Check(stroke, terrain_, GateSampling::kCoarse).accepted;
    const GateVerdict verdict = gate_.Check(stroke, terrain_, GateSampling::kFine);
    EXPECT_TRUE(verdict.accepted || !is_coarse)
        << sample << ::testing::PrintToString(verdict.reasons);
    coarse += is_coarse, fine += verdict.accepted;
  }
  EXPECT_GT(coarse, 200);
  EXPECT_GT(coarse, 0.95 * fine);  // and it refuses little more
}

TEST_F(Gate, ServesManyThreadsWithTheSameVerdicts) {
  constexpr int kStrokes = 60;
  std::vector<Stroke> strokes;
  RandomStream random(8);
  for (int i = 0; i < kStrokes; ++i) strokes.push_back(RandomStroke(1.2, 0.8, random));
  std::vector<double> alone(kStrokes), together(kStrokes);
  const auto figure = [&](int i) {
    const auto v = gate_.Check(strokes[static_cast<size_t>(i)], terrain_, GateSampling::kCoarse);
    return v.accepted + v.min_clearance_m + v.min_singular_value + v.branch;
  };
  for (int i = 0; i < kStrokes; ++i) alone[static_cast<size_t>(i)] = figure(i);
  ParallelFor(kStrokes, 4, [&](int i) { together[static_cast<size_t>(i)] = figure(i); });
  EXPECT_EQ(alone, together);
}

TEST_F(Gate, TransfersAreCheckedToo) {
  const Workcell& cell = gate_.workcell();
  const auto good = gate_.CheckTransfer(cell.home(), cell.camera_pose(), terrain_);
  EXPECT_TRUE(good.accepted) << ::testing::PrintToString(good.reasons);
  EXPECT_FALSE(good.knots.empty());
  JointAngles low = cell.home();
  low.rad[1] += 0.9;  // leans the arm into the box
  const auto bad = gate_.CheckTransfer(cell.home(), low, terrain_);
  EXPECT_FALSE(bad.accepted);
  EXPECT_TRUE(bad.knots.empty());
}

}  // namespace
}  // namespace sandwright
