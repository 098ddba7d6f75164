#include "robot_model/urscript_writer.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "data/base/error.h"

namespace sandwright {
namespace {

// Waypoints of a curve; the controller rounds the corners between them.
constexpr double kCurveStep_m = 0.010, kCurveTurn_rad = 0.15;
constexpr double kBlendShare = 0.4;  // of the shorter neighbouring segment: two blends never meet
constexpr double kLargestBlend_m = 0.003;
constexpr double kSmallestBlend_m = 0.0002;  // below it the waypoint is passed without a blend

double Distance(const BladePose& a, const BladePose& b) {
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m);
}

// X_WT as the controller writes it, where the TCP is X_FT.
std::string PoseText(const Eigen::Isometry3d& X_WT) {
  const Eigen::AngleAxisd turn(X_WT.linear());
  const Eigen::Vector3d r = turn.angle() * turn.axis(), p = X_WT.translation();
  return fmt::format("p[{:.5f}, {:.5f}, {:.5f}, {:.5f}, {:.5f}, {:.5f}]", p.x(), p.y(), p.z(),
                     r.x(), r.y(), r.z());
}

}  // namespace

void CheckProgramName(const std::string& name) {
  if (name.size() > 31 || !std::regex_match(name, std::regex("[A-Za-z]\\w*")))
    throw Error("URScript program name '" + name +
                "': a letter, then letters, digits or _; at most 31 characters");
}

UrScriptWriter::UrScriptWriter(const SafetyGate& gate, double speed_share, int counter)
    : gate_(gate), settings_(gate.workcell().motion), share_(speed_share), counter_(counter) {
  SAND_CHECK(speed_share > 0 && speed_share <= 1, speed_share);
}

void UrScriptWriter::Cell() {
  const Workcell& cell = gate_.workcell();
  Comment(fmt::format("workcell {} {}", cell.name, WorkcellHash(cell).substr(0, 16)));
  Comment(fmt::format("arm calibration {}", CalibrationHash(cell).substr(0, 16)));
}

void UrScriptWriter::RequireJoints(const JointAngles& q, const std::string& message,
                                   const std::string& otherwise) {
  Line("q = get_actual_joint_positions()");
  for (int i = 0; i < 6; ++i) Line(fmt::format("off_{} = norm(q[{}] - ({:.6f}))", i + 1, i, q[i]));
  Line(fmt::format("if (off_1 > {0} or off_2 > {0} or off_3 > {0} or off_4 > {0} or off_5 > {0} or "
                   "off_6 > {0}):",
                   kProgramStart_rad));
  if (!otherwise.empty()) Line("  " + otherwise);
  Line("  textmsg(\"Sandwright: " + message + "\")");
  Line("  halt");
  Line("end");
}

void UrScriptWriter::Joints(const JointAngles& q) {
  Move(fmt::format("movej([{:.6f}, {:.6f}, {:.6f}, {:.6f}, {:.6f}, {:.6f}], a={:.3f}, v={:.3f})",
                   q[0], q[1], q[2], q[3], q[4], q[5],
                   settings_.transfer_acceleration_radps2 * share_ * share_,
                   settings_.transfer_speed_radps * share_));
}

void UrScriptWriter::StrokeMoves(const Stroke& stroke, const StrokeMotion& motion) {
  flipped_ = motion.flipped;
  Joints(motion.knots.front());
  for (const PathPiece& piece : StrokePieces(stroke, settings_)) {
    const BladePose& end = piece.poses.back();
    switch (piece.kind) {
      case PathPiece::Kind::kTurn: Turn(end, piece.timing.duration_s()); break;
      case PathPiece::Kind::kCurve: Curve(piece); break;
      case PathPiece::Kind::kStraight: Straight(end, stroke.speed_mps); break;
      case PathPiece::Kind::kDown:
      case PathPiece::Kind::kUp:
        if (piece.length() > 0) Straight(end, settings_.vertical_speed_mps);
        break;
    }
  }
}

void UrScriptWriter::BladeTo(const JointAngles& q, double speed_mps) {
  const Eigen::Isometry3d X_WT =
      gate_.kinematics().arm().Forward(q) * gate_.workcell().tool.X_FT.ToIsometry();
  Move(fmt::format("movel({}, {})", PoseText(X_WT), Speed(speed_mps)));
}

void UrScriptWriter::Move(const std::string& text) {
  if (counter_ >= 0) Line(fmt::format("write_output_integer_register({}, {})", counter_, moves_++));
  Line(text);
}

void UrScriptWriter::Straight(const BladePose& pose, double speed_mps) {
  Move(fmt::format("movel({}, {})", Pose(pose), Speed(speed_mps)));
}

void UrScriptWriter::Turn(const BladePose& pose, double duration_s) {
  Move(fmt::format("movel({}, t={:.3f})", Pose(pose), duration_s / share_));
}

// Waypoints with the speed of the gate's motion on the way to each: slow where the curve is sharp.
void UrScriptWriter::Curve(const PathPiece& piece) {
  std::vector<BladePose> points = {piece.poses.front()};
  std::vector<double> at = {0};
  for (size_t i = 1; i < piece.poses.size(); ++i) {
    const BladePose& pose = piece.poses[i];
    const bool last = i + 1 == piece.poses.size();
    if (!last && Distance(pose, points.back()) < kCurveStep_m &&
        std::abs(pose.yaw_rad - points.back().yaw_rad) < kCurveTurn_rad)
      continue;
    points.push_back(pose);
    at.push_back(piece.sigma[i]);
  }
  for (size_t i = 1; i < points.size(); ++i) {
    const double step = Distance(points[i - 1], points[i]);
    const double speed = piece.timing.speed() * step / (at[i] - at[i - 1]);
    if (i + 1 == points.size()) return Straight(points[i], speed);
    const double blend =
        std::min(kLargestBlend_m, kBlendShare * std::min(step, Distance(points[i], points[i + 1])));
    Move(fmt::format("movep({}, {}, r={:.4f})", Pose(points[i]), Speed(speed),
                     blend < kSmallestBlend_m ? 0 : blend));
  }
}

std::string UrScriptWriter::Pose(const BladePose& pose) const {
  return PoseText(gate_.kinematics().FlangePose(pose, flipped_) *
                  gate_.workcell().tool.X_FT.ToIsometry());
}

std::string UrScriptWriter::Speed(double speed_mps) const {
  return fmt::format("a={:.3f}, v={:.4f}", settings_.path_acceleration_mps2 * share_ * share_,
                     speed_mps * share_);
}

}  // namespace sandwright
