// Time along a path, and strokes as joint motion.
#include "robot_model/stroke_motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "robot_model/curve_speed.h"
#include "robot_model/rest_to_rest.h"
#include "tests/support/random_strokes.h"

namespace sandwright {
namespace {

TEST(RestToRest, HandNumbers) {
  // 0.5 m/s^2 to 0.1 m/s takes 0.2 s; 0.18 m at 0.1 m/s takes 1.8 s;
  // one ramp and the smoothing more.
  const RestToRest motion(0.18, 0.1, 0.5, 0.1);
  EXPECT_NEAR(motion.duration_s(), 1.8 + 0.2 + 0.1, 1e-12);
  EXPECT_DOUBLE_EQ(motion.At(0), 0);
  EXPECT_DOUBLE_EQ(motion.At(motion.duration_s()), 0.18);
  EXPECT_NEAR(motion.At(motion.duration_s() / 2), 0.09, 1e-12);
  const RestToRest shortest(0.002, 0.1, 0.5, 0.1);  // never reaches its speed
  EXPECT_NEAR(shortest.speed(), std::sqrt(0.002 * 0.5), 1e-12);
  EXPECT_EQ(RestToRest(0, 0.1, 0.5, 0.1).duration_s(), 0);
}

TEST(RestToRest, KeepsSpeedAccelerationAndJerk) {
  for (const double length : {0.001, 0.01, 0.05, 0.3}) {
    const RestToRest motion(length, 0.1, 0.5, 0.1);
    constexpr double h = 1e-4;
    double before = 0;
    for (double t = -0.05; t < motion.duration_s() + 0.05; t += h) {
      const double s0 = motion.At(t), s1 = motion.At(t + h), s2 = motion.At(t + 2 * h),
                   s3 = motion.At(t + 3 * h);
      EXPECT_GE(s0, before - 1e-15);
      EXPECT_LE((s1 - s0) / h, 0.1 * (1 + 1e-6));
      EXPECT_LE(std::abs(s2 - 2 * s1 + s0) / (h * h), 0.5 * (1 + 1e-4));
      EXPECT_LE(std::abs(s3 - 3 * s2 + 3 * s1 - s0) / (h * h * h), 2 * 0.5 / 0.1 * (1 + 1e-2));
      before = s0;
    }
  }
}

TEST(StrokePieces, PolylineStopsAndTurnsAtItsCorners) {
  const Stroke stroke{{{0.5, 0.3, 0.03}, {0.6, 0.3, 0.03}, {0.6, 0.4, 0.02}}, 1, 0.1};
  const MotionSettings settings;
  const auto pieces = StrokePieces(stroke, settings);
  ASSERT_EQ(pieces.size(), 5u);  // down, straight, turn, straight, up
  EXPECT_EQ(pieces[0].kind, PathPiece::Kind::kDown);
  EXPECT_NEAR(pieces[0].At(0).z_m, settings.retreat_height_m, 1e-15);
  EXPECT_EQ(pieces[2].kind, PathPiece::Kind::kTurn);
  EXPECT_NEAR(pieces[2].length(), std::numbers::pi / 2, 1e-12);
  EXPECT_NEAR(pieces[3].length(), std::hypot(0.1, 0.01), 1e-12);
  for (size_t i = 0; i + 1 < pieces.size(); ++i) {  // each piece goes on where the last one ended
    const BladePose end = pieces[i].poses.back(), begin = pieces[i + 1].poses.front();
    EXPECT_NEAR(end.x_m, begin.x_m, 1e-15);
    EXPECT_NEAR(end.y_m, begin.y_m, 1e-15);
    EXPECT_NEAR(end.z_m, begin.z_m, 1e-15);
    EXPECT_NEAR(end.yaw_rad, begin.yaw_rad, 1e-15);
  }
}

TEST(CurveSpeed, IsTheStrokesOwnOnGentleCurvesAndLessInAbruptOnes) {
  const MotionSettings settings;
  const Stroke gentle{{{0.3, 0.3, 0.03}, {0.4, 0.33, 0.03}, {0.5, 0.3, 0.03}}, 2, 0.1};
  EXPECT_DOUBLE_EQ(CurveSpeed(gentle, settings), 0.1);
  // Where a hairpin's bend sets in, the turning must be built up first: a little slower.
  const Stroke hairpin{{{0.3, 0.3, 0.03}, {0.5, 0.31, 0.03}, {0.3, 0.32, 0.03}}, 2, 0.1};
  EXPECT_LT(CurveSpeed(hairpin, settings), 0.1);
  EXPECT_GT(CurveSpeed(hairpin, settings), 0.05);
  // A bend that reverses within millimetres: much slower.
  const Stroke abrupt{
      {{0.3, 0.3, 0.03}, {0.5, 0.38, 0.03}, {0.3, 0.26, 0.03}, {0.5, 0.34, 0.03}}, 2, 0.1};
  EXPECT_LT(CurveSpeed(abrupt, settings), CurveSpeed(hairpin, settings));
  EXPECT_GT(CurveSpeed(abrupt, settings), 0);
}

TEST(StrokeMotion, StaysOnThePathInOneBranch) {
  const Workcell cell;
  const BladeKinematics kinematics(cell);
  RandomStream random(4);
  int followed = 0;
  for (int sample = 0; sample < 60; ++sample) {
    Stroke stroke = RandomStroke(0.8, 0.6, random);
    for (auto& point : stroke.control_points_m) point.head<2>().array() += 0.1;
    if (stroke.degree == 2 && stroke.control_points_m.size() > 2 &&
        CurveSpeed(stroke, cell.motion) < 0.02)
      continue;
    const auto pieces = StrokePieces(stroke, cell.motion);
    const auto motion = MakeStrokeMotion(pieces, kinematics, 6, sample % 2 == 1, cell.home());
    if (!motion) continue;
    ++followed;
    EXPECT_LT(PathError(*motion, kinematics, stroke), 0.2e-3);
    const Eigen::Vector3d first =
        kinematics.BladeInBox(motion->knots[motion->path_begin]).translation();
    const Eigen::Vector3d last =
        kinematics.BladeInBox(motion->knots[motion->path_end - 1]).translation();
    EXPECT_LT((first - stroke.control_points_m.front()).norm(), 1e-9);
    EXPECT_LT((last - stroke.control_points_m.back()).norm(), 1e-9);
    for (size_t i = 1; i < motion->knots.size(); ++i)
      ASSERT_LT((motion->knots[i].rad - motion->knots[i - 1].rad).cwiseAbs().maxCoeff(), 0.05);
    // Upright all the way: the blade's z axis points down.
    EXPECT_NEAR(kinematics.BladeInBox(motion->knots[motion->knots.size() / 2]).linear()(2, 2), -1,
                1e-9);
  }
  EXPECT_GT(followed, 40);
}

TEST(StrokeMotion, BladeWorksBothWaysRound) {
  const Workcell cell;
  const BladeKinematics kinematics(cell);
  const BladePose pose{0.6, 0.4, 0.05, 0.7};
  const auto plain = kinematics.Solve(pose, 6, false, cell.home());
  const auto flipped = kinematics.Solve(pose, 6, true, cell.home());
  ASSERT_TRUE(plain && flipped);
  EXPECT_LT((plain->rad - flipped->rad).head<5>().norm(),
            1e-9);  // only joint 6 differs, by half a turn
  EXPECT_NEAR(std::abs(plain->rad[5] - flipped->rad[5]), std::numbers::pi, 1e-9);
}

TEST(Transfer, IsStraightAndEndsWhereItShould) {
  const Workcell cell;
  const auto knots = TransferKnots(cell.home(), cell.camera_pose(), cell.motion);
  EXPECT_EQ(knots.front().rad, cell.home().rad);
  EXPECT_LT((knots.back().rad - cell.camera_pose().rad).norm(), 1e-12);
  EXPECT_EQ(TransferKnots(cell.home(), cell.home(), cell.motion).size(), 1u);
}

}  // namespace
}  // namespace sandwright
