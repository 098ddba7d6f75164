#include "robot_model/urscript.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <regex>

#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr double kStartTolerance_rad = 0.02;
// Waypoints of a curve; the controller rounds the corners between them.
constexpr double kCurveStep_m = 0.010, kCurveTurn_rad = 0.15;
constexpr double kBlendShare = 0.4;  // of the shorter neighbouring segment: two blends never meet
constexpr double kLargestBlend_m = 0.003;
constexpr double kSmallestBlend_m = 0.0002;  // below it the waypoint is passed without a blend

class Writer {
 public:
  explicit Writer(const SafetyGate& gate) : gate_(gate), settings_(gate.workcell().motion) {}

  void Line(const std::string& text) { text_ += "  " + text + "\n"; }
  void Comment(const std::string& text) { Line("# " + text); }

  void Joints(const JointAngles& q) {
    Line(fmt::format("movej([{:.6f}, {:.6f}, {:.6f}, {:.6f}, {:.6f}, {:.6f}], a={:.3f}, v={:.3f})",
                     q[0], q[1], q[2], q[3], q[4], q[5], settings_.transfer_acceleration_radps2,
                     settings_.transfer_speed_radps));
  }
  // Straight to a pose at a speed, stopping there.
  void Straight(const BladePose& pose, double speed_mps) {
    Line(fmt::format("movel({}, a={:.3f}, v={:.4f})", Pose(pose), settings_.path_acceleration_mps2,
                     speed_mps));
  }
  void Turn(const BladePose& pose, double duration_s) {
    Line(fmt::format("movel({}, t={:.3f})", Pose(pose), duration_s));
  }
  void Through(const BladePose& pose, double speed_mps, double blend_m) {
    Line(fmt::format("movep({}, a={:.3f}, v={:.4f}, r={:.4f})", Pose(pose),
                     settings_.path_acceleration_mps2, speed_mps, blend_m));
  }
  void Flip(bool flipped) { flipped_ = flipped; }
  std::string Take() { return std::move(text_); }

 private:
  // X_WT as the controller writes it, with set_tcp at X_FT.
  std::string Pose(const BladePose& pose) const {
    const Eigen::Isometry3d X =
        gate_.kinematics().FlangePose(pose, flipped_) * gate_.workcell().tool.X_FT.ToIsometry();
    const Eigen::AngleAxisd turn(X.linear());
    const Eigen::Vector3d r = turn.angle() * turn.axis(), p = X.translation();
    return fmt::format("p[{:.5f}, {:.5f}, {:.5f}, {:.5f}, {:.5f}, {:.5f}]", p.x(), p.y(), p.z(),
                       r.x(), r.y(), r.z());
  }

  const SafetyGate& gate_;
  const MotionSettings& settings_;
  bool flipped_ = false;
  std::string text_;
};

double Distance(const BladePose& a, const BladePose& b) {
  return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m, a.z_m - b.z_m);
}

// Waypoints with the speed of the gate's motion on the way to each: slow where the curve is sharp.
void WriteCurve(const PathPiece& piece, Writer& writer) {
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
    if (i + 1 == points.size()) return writer.Straight(points[i], speed);
    const double blend =
        std::min(kLargestBlend_m, kBlendShare * std::min(step, Distance(points[i], points[i + 1])));
    writer.Through(points[i], speed, blend < kSmallestBlend_m ? 0 : blend);
  }
}

void WriteStroke(const Stroke& stroke, const StrokeMotion& motion, const SafetyGate& gate,
                 Writer& writer) {
  const auto pieces = StrokePieces(stroke, gate.workcell().motion);
  writer.Flip(motion.flipped);
  writer.Joints(motion.knots.front());
  for (const PathPiece& piece : pieces) {
    const BladePose& end = piece.poses.back();
    switch (piece.kind) {
      case PathPiece::Kind::kTurn: writer.Turn(end, piece.timing.duration_s()); break;
      case PathPiece::Kind::kCurve: WriteCurve(piece, writer); break;
      case PathPiece::Kind::kStraight: writer.Straight(end, stroke.speed_mps); break;
      case PathPiece::Kind::kDown:
      case PathPiece::Kind::kUp:
        if (piece.length() > 0) writer.Straight(end, gate.workcell().motion.vertical_speed_mps);
        break;
    }
  }
}

void WriteHead(const Workcell& cell, size_t strokes, Writer& writer) {
  const ToolSettings& tool = cell.tool;
  const auto& c = tool.centre_of_mass_m;
  const auto& t = tool.X_FT.translation_m;
  const auto& r = tool.X_FT.rotation_vector_rad;
  writer.Comment(fmt::format("workcell {} {}", cell.name, WorkcellHash(cell).substr(0, 16)));
  writer.Comment(fmt::format("arm calibration {}", CalibrationHash(cell).substr(0, 16)));
  writer.Line(
      fmt::format("set_payload({:.3f}, [{:.4f}, {:.4f}, {:.4f}])", tool.mass_kg, c[0], c[1], c[2]));
  writer.Line(fmt::format("set_tcp(p[{:.5f}, {:.5f}, {:.5f}, {:.5f}, {:.5f}, {:.5f}])", t[0], t[1],
                          t[2], r[0], r[1], r[2]));
  writer.Comment("the arm must stand at home");
  writer.Line("q = get_actual_joint_positions()");
  for (int i = 0; i < 6; ++i) {
    writer.Line(fmt::format("off_{} = norm(q[{}] - ({:.6f}))", i + 1, i, cell.home()[i]));
  }
  writer.Line(
      fmt::format("if (off_1 > {0} or off_2 > {0} or off_3 > {0} or off_4 > {0} or off_5 > {0} or "
                  "off_6 > {0}):",
                  kStartTolerance_rad));
  writer.Line("  textmsg(\"Sandwright: the arm is not at home; nothing was moved\")");
  writer.Line("  halt");
  writer.Line("end");
  writer.Line(
      fmt::format("popup(\"{} strokes in the sand box. Keep clear; continue to start.\", "
                  "title=\"Sandwright\", warning=True, error=False, blocking=True)",
                  strokes));
}

}  // namespace

std::string MakeUrScript(const std::vector<Stroke>& strokes, const PlanVerdict& verdict,
                         const SafetyGate& gate, const std::string& name) {
  SAND_CHECK(verdict.accepted && verdict.strokes.size() == strokes.size(), verdict.strokes.size(),
             strokes.size());
  if (name.size() > 31 || !std::regex_match(name, std::regex("[A-Za-z]\\w*")))
    throw Error("URScript program name '" + name +
                "': a letter, then letters, digits or _; at most 31 characters");
  Writer writer(gate);
  WriteHead(gate.workcell(), strokes.size(), writer);
  for (size_t i = 0; i < strokes.size(); ++i) {
    writer.Comment(fmt::format("stroke {}: {:.1f} s, branch {}", i, verdict.strokes[i].duration_s,
                               verdict.strokes[i].branch));
    WriteStroke(strokes[i], *verdict.strokes[i].motion, gate, writer);
  }
  writer.Comment("home");
  writer.Joints(gate.workcell().home());
  writer.Line("textmsg(\"Sandwright: all strokes done\")");
  return "def " + name + "():\n" + writer.Take() + "end\n";
}

}  // namespace sandwright
