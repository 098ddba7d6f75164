// Lines of URScript for moves that the gate has looked at.
#pragma once

#include <string>

#include "robot_model/gated_motion.h"
#include "robot_model/safety_gate.h"

namespace sandwright {

// The joints may stand this far from where a program begins.
inline constexpr double kProgramStart_rad = 0.02;

// Throws Error unless `name` is a letter, then letters, digits or _, at most 31 characters.
void CheckProgramName(const std::string& name);

// Collects the body of a program: scalar URScript for PolyScope 3, two spaces in.
class UrScriptWriter {
 public:
  // Speeds are times `speed_share` (0..1], accelerations times its square. With a `counter` each
  // movement is announced in that output integer register, from 0.
  explicit UrScriptWriter(const SafetyGate& gate, double speed_share = 1, int counter = -1);

  void Line(const std::string& text) { text_ += "  " + text + "\n"; }
  void Comment(const std::string& text) { Line("# " + text); }
  // Which cell and which arm the program is for.
  void Cell();
  // Leaves the program with a message, and `otherwise` before it, unless each joint stands at `q`.
  void RequireJoints(const JointAngles& q, const std::string& message,
                     const std::string& otherwise = "");
  // Straight in joint space.
  void Joints(const JointAngles& q);
  // From the entry into the stroke's branch to the blade above its end.
  void StrokeMoves(const Stroke& stroke, const StrokeMotion& motion);
  // The blade straight to where it is at `q`.
  void BladeTo(const JointAngles& q, double speed_mps);
  std::string Take() { return std::move(text_); }

 private:
  void Move(const std::string& text);
  void Straight(const BladePose& pose, double speed_mps);
  void Turn(const BladePose& pose, double duration_s);
  void Curve(const PathPiece& piece);
  std::string Pose(const BladePose& pose) const;
  std::string Speed(double speed_mps) const;

  const SafetyGate& gate_;
  const MotionSettings& settings_;
  double share_;
  int counter_, moves_ = 0;
  bool flipped_ = false;
  std::string text_;
};

}  // namespace sandwright
