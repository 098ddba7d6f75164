#include "robot_model/stroke_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "robot_model/curve_speed.h"

namespace sandwright {
namespace {

constexpr double kPi = std::numbers::pi;
// Spacing of a curve's poses. Far below one controller period of travel (0.8 mm), so that
// the corners between them do not show as jerk.
constexpr double kFineStep_m = 0.05e-3, kFineTurn_rad = 0.0025;
constexpr double kCoarseStep_m = 5e-3, kCoarseTurn_rad = 0.1;

double Distance(const BladePose& a, const BladePose& b) {
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m);
}

PathPiece LinearPiece(PathPiece::Kind kind, const BladePose& from, const BladePose& to,
                      double speed, double acceleration, const MotionSettings& settings) {
  const double length =
      kind == PathPiece::Kind::kTurn ? std::abs(to.yaw_rad - from.yaw_rad) : Distance(from, to);
  return {
      kind, {from, to}, {0, length}, RestToRest(length, speed, acceleration, settings.smoothing_s)};
}

void AppendPolyline(const Stroke& stroke, const MotionSettings& settings,
                    std::vector<PathPiece>& pieces) {
  const auto& points = stroke.control_points_m;
  double yaw = 0;
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const Eigen::Vector3d a = points[i], b = points[i + 1];
    double heading = std::atan2(b.y() - a.y(), b.x() - a.x());
    if (i > 0) {
      heading -= 2 * kPi * std::round((heading - yaw) / (2 * kPi));
      if (heading != yaw)
        pieces.push_back(LinearPiece(PathPiece::Kind::kTurn, {a.x(), a.y(), a.z(), yaw},
                                     {a.x(), a.y(), a.z(), heading}, settings.turn_speed_radps,
                                     settings.turn_acceleration_radps2, settings));
    }
    yaw = heading;
    pieces.push_back(LinearPiece(PathPiece::Kind::kStraight, {a.x(), a.y(), a.z(), yaw},
                                 {b.x(), b.y(), b.z(), yaw}, stroke.speed_mps,
                                 settings.path_acceleration_mps2, settings));
  }
}

PathPiece CurvePiece(const Stroke& stroke, const MotionSettings& settings, CurveSampling sampling) {
  const double metres_per_rad = MetresPerRadian(stroke, settings);
  ToolPath poses = sampling == CurveSampling::kFine
                       ? SamplePath(stroke, kFineStep_m, kFineTurn_rad)
                       : SamplePath(stroke, kCoarseStep_m, kCoarseTurn_rad);
  std::vector<double> sigma = {0};
  for (size_t i = 1; i < poses.size(); ++i)
    sigma.push_back(sigma.back() +
                    std::hypot(Distance(poses[i - 1], poses[i]),
                               metres_per_rad * (poses[i].yaw_rad - poses[i - 1].yaw_rad)));
  const RestToRest timing(sigma.back(), CurveSpeed(stroke, settings),
                          settings.path_acceleration_mps2, settings.smoothing_s);
  return {PathPiece::Kind::kCurve, std::move(poses), std::move(sigma), timing};
}

double PointToSegment(const Eigen::Vector3d& p, const BladePose& a, const BladePose& b) {
  const Eigen::Vector3d start(a.x_m, a.y_m, a.z_m),
      d = Eigen::Vector3d(b.x_m, b.y_m, b.z_m) - start;
  const double t =
      d.squaredNorm() > 0 ? std::clamp((p - start).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
  return (start + t * d - p).norm();
}

}  // namespace

BladePose PathPiece::At(double sigma_value) const {
  const auto above = std::ranges::upper_bound(sigma, sigma_value);
  const size_t i = std::clamp<std::ptrdiff_t>(above - sigma.begin(), 1, std::ssize(sigma) - 1);
  const double span = sigma[i] - sigma[i - 1];
  const double t = span > 0 ? std::clamp((sigma_value - sigma[i - 1]) / span, 0.0, 1.0) : 1;
  const BladePose &a = poses[i - 1], &b = poses[i];
  return {a.x_m + t * (b.x_m - a.x_m), a.y_m + t * (b.y_m - a.y_m), a.z_m + t * (b.z_m - a.z_m),
          a.yaw_rad + t * (b.yaw_rad - a.yaw_rad)};
}

std::vector<PathPiece> StrokePieces(const Stroke& stroke, const MotionSettings& settings,
                                    CurveSampling sampling) {
  CheckStroke(stroke, "stroke");
  std::vector<PathPiece> path;
  if (stroke.degree == 1 || stroke.control_points_m.size() == 2) {
    AppendPolyline(stroke, settings, path);
  } else {
    path.push_back(CurvePiece(stroke, settings, sampling));
  }
  const auto vertical = [&](PathPiece::Kind kind, BladePose from, BladePose to) {
    return LinearPiece(kind, from, to, settings.vertical_speed_mps, settings.path_acceleration_mps2,
                       settings);
  };
  const BladePose first = path.front().poses.front(), last = path.back().poses.back();
  BladePose above_first = first, above_last = last;
  above_first.z_m = std::max(settings.retreat_height_m, first.z_m);
  above_last.z_m = std::max(settings.retreat_height_m, last.z_m);
  std::vector<PathPiece> pieces;
  pieces.push_back(vertical(PathPiece::Kind::kDown, above_first, first));
  std::ranges::move(path, std::back_inserter(pieces));
  pieces.push_back(vertical(PathPiece::Kind::kUp, last, above_last));
  return pieces;
}

BladeKinematics::BladeKinematics(const Workcell& workcell)
    : arm_(workcell.kinematics),
      X_WB_(workcell.X_WB.ToIsometry()),
      X_BW_(X_WB_.inverse()),
      X_FT_(workcell.tool.X_FT.ToIsometry()),
      X_TF_(X_FT_.inverse()) {}

Eigen::Isometry3d BladeKinematics::FlangePose(const BladePose& pose, bool flipped) const {
  // T's x is the blade's normal, its z points down.
  const double yaw = flipped ? pose.yaw_rad + kPi : pose.yaw_rad;
  const double c = std::cos(yaw), s = std::sin(yaw);
  Eigen::Isometry3d X_BT = Eigen::Isometry3d::Identity();
  X_BT.linear() << c, s, 0, s, -c, 0, 0, 0, -1;
  X_BT.translation() << pose.x_m, pose.y_m, pose.z_m;
  return X_WB_ * X_BT * X_TF_;
}

Eigen::Isometry3d BladeKinematics::BladeInBox(const JointAngles& q) const {
  return X_BW_ * arm_.Forward(q) * X_FT_;
}

std::optional<JointAngles> BladeKinematics::Solve(const BladePose& pose, Branch branch,
                                                  bool flipped, const JointAngles& near) const {
  const auto solution = arm_.Inverse(FlangePose(pose, flipped), branch, near[5]);
  if (!solution) return std::nullopt;
  return NearestTurns(solution->q, near);
}

std::optional<StrokeMotion> MakeStrokeMotion(const std::vector<PathPiece>& pieces,
                                             const BladeKinematics& kinematics, Branch branch,
                                             bool flipped, const JointAngles& near) {
  StrokeMotion motion;
  motion.branch = branch;
  motion.flipped = flipped;
  JointAngles q = near;
  const auto add = [&](const BladePose& pose) {
    const auto next = kinematics.Solve(pose, branch, flipped, q);
    if (next) motion.knots.push_back(q = *next);
    return next.has_value();
  };
  if (!add(pieces.front().At(0))) return std::nullopt;
  for (const PathPiece& piece : pieces) {
    if (piece.kind == PathPiece::Kind::kUp) motion.path_end = motion.knots.size();
    // Whole periods: the last step of a piece is a little short of its time, never beyond its end.
    const int steps =
        static_cast<int>(std::ceil(piece.timing.duration_s() / StrokeMotion::kPeriod_s));
    for (int k = 1; k <= steps; ++k) {
      if (!add(piece.At(piece.timing.At(k * StrokeMotion::kPeriod_s)))) return std::nullopt;
    }
    if (piece.kind == PathPiece::Kind::kDown) motion.path_begin = motion.knots.size() - 1;
  }
  return motion;
}

std::vector<JointAngles> TransferKnots(const JointAngles& from, const JointAngles& to,
                                       const MotionSettings& settings) {
  const double farthest = (to.rad - from.rad).cwiseAbs().maxCoeff();
  const RestToRest timing(farthest, settings.transfer_speed_radps,
                          settings.transfer_acceleration_radps2, settings.smoothing_s);
  std::vector<JointAngles> knots = {from};
  const int steps = static_cast<int>(std::ceil(timing.duration_s() / StrokeMotion::kPeriod_s));
  for (int k = 1; k <= steps; ++k) {
    JointAngles q;
    q.rad = from.rad + (to.rad - from.rad) * (timing.At(k * StrokeMotion::kPeriod_s) / farthest);
    knots.push_back(q);
  }
  return knots;
}

double PathError(const StrokeMotion& motion, const BladeKinematics& kinematics,
                 const Stroke& stroke) {
  const ToolPath path = SamplePath(stroke, 0.5e-3, kCoarseTurn_rad);
  double worst = 0;
  size_t at = 0;
  for (size_t i = motion.path_begin; i + 1 < motion.path_end; ++i) {
    JointAngles middle;
    middle.rad = 0.5 * (motion.knots[i].rad + motion.knots[i + 1].rad);
    const Eigen::Vector3d p = kinematics.BladeInBox(middle).translation();
    // The nearest stretch of path not far ahead: the motion never goes back along it.
    double nearest = PointToSegment(p, path[at], path[std::min(at + 1, path.size() - 1)]);
    for (size_t j = at + 1; j + 1 < std::min(path.size(), at + 80); ++j) {
      const double distance = PointToSegment(p, path[j], path[j + 1]);
      if (distance < nearest) nearest = distance, at = j;
    }
    worst = std::max(worst, nearest);
  }
  return worst;
}

}  // namespace sandwright
