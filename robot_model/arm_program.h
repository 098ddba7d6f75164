// One gated motion as a guarded URScript program for the controller.
#pragma once

#include <string>

#include "robot_model/gated_motion.h"
#include "robot_model/safety_gate.h"

namespace sandwright {

// The registers through which program and PC talk (RTDE, general purpose).
struct ProgramRegisters {
  // PC to arm.
  static constexpr int kBeat = 0;     // input int: changes at least every 100 ms, or the program stops
  static constexpr int kCommand = 1;  // input int: 0 go on, 1 stop
  // Arm to PC.
  static constexpr int kSegment = 0;  // output int: the movement under way, counted from 0
  static constexpr int kPhase = 1;    // output int: a ProgramPhase
  static constexpr int kPulse = 2;    // output int: changes every 8 ms while the program lives
};

enum class ProgramPhase {
  kIdle = 0,
  kRunning = 1,
  kFinished = 2,
  // The program has stopped the arm by itself and ended.
  kNotAtStart = 10,
  kOtherTcp = 11,
  kOtherPayload = 12,
  kBeatLost = 13,
  kAskedToStop = 14,
};

// Made from a gated motion only, so that no other program can be sent to an arm.
class ArmProgram {
 public:
  const std::string& name() const { return name_; }  // at most 31 characters
  const std::string& text() const { return text_; }
  const GatedMotion& motion() const { return motion_; }
  // At a full speed slider, without pauses.
  double duration_s() const { return motion_.duration_s() / speed_share_; }

 private:
  friend ArmProgram MakeArmProgram(const GatedMotion& motion, const SafetyGate& gate,
                                   const std::string& name, double speed_share);
  explicit ArmProgram(GatedMotion motion) : motion_(std::move(motion)) {}

  std::string name_, text_;
  GatedMotion motion_;
  double speed_share_ = 1;
};

// The program compares the installation's TCP and payload with the workcell's and the arm's joints
// with the motion's start before it moves; a thread in it stops the arm when the PC's beat is lost
// or a stop is asked for. All speeds are times `speed_share` (0..1], accelerations times its square.
ArmProgram MakeArmProgram(const GatedMotion& motion, const SafetyGate& gate,
                          const std::string& name, double speed_share = 1);

}  // namespace sandwright
