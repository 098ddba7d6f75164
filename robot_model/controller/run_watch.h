// The judge of one run: frames and events in, a verdict out. Values only, no connection.
#pragma once

#include <optional>
#include <vector>

#include "robot_model/controller/force_guard.h"
#include "robot_model/controller/motion_progress.h"
#include "robot_model/controller/run_end.h"
#include "robot_model/controller/script_progress.h"

namespace sandwright {

// What a run is watched against.
struct RunPlan {
  std::string name;                // of the program
  std::vector<JointAngles> knots;  // the whole motion
  size_t stroke_begin = 0;         // of entry, path and exit; knots.size() without a stroke
  size_t path_begin = 0;           // of the path itself
  double duration_s = 0;           // at a full speed slider, without pauses
};

// One frame with what the watch made of it, for the log.
struct RunSample {
  ArmState state;
  double time_s = 0;  // of the controller, since the first sample
  size_t knot = 0;
  double deviation_rad = 0;
  double contact_n = 0;
};

// A stop, violation or fault of the safety system, or an arm that is not RUNNING; none where the
// arm is fit to move.
std::optional<RunVerdict> SafetyVerdict(const ArmState& state);

class RunWatch {
 public:
  static constexpr double kLargestDeviation_rad = 0.05;  // of a joint from the nearest planned knot
  static constexpr double kEndTolerance_rad = 0.02;
  static constexpr double kStartTime_s = 10;  // long programs are parsed for seconds
  // Pauses do not count and a slow slider stretches it. The controller's own accelerations are not
  // the plan's.
  static constexpr double kDurationShare = 1.5, kDurationMore_s = 3;

  // `before`: the arm as it is when the program is about to be sent; registers keep what an earlier
  // program has left in them.
  RunWatch(RunPlan plan, const MotionLimits& limits, ForceBaseline baseline,
           const ArmState& before);

  void Take(const PrimaryItem& item);
  RunSample Take(const ArmState& state);
  // The first thing that ends the run, by severity; none while it goes on.
  std::optional<RunVerdict> Judge() const;
  // Our program holds the arm no more.
  bool program_over() const;
  const ScriptProgress& script() const { return script_; }

 private:
  std::optional<RunVerdict> JudgeSafety() const;
  std::optional<RunVerdict> JudgeScript() const;
  std::optional<RunVerdict> JudgePhase() const;
  std::optional<RunVerdict> JudgeMotion() const;
  std::optional<RunVerdict> JudgeEnd() const;
  bool says_ended() const;
  int32_t phase() const;

  RunPlan plan_;
  ScriptProgress script_;
  ForceGuard force_;
  MotionProgress progress_;
  ArmState before_, state_;
  RobotModeData mode_;         // news on the other connection, where this one is stuck
  bool ran_ = false;           // the program has said so itself
  double time_s_ = 0;          // since `before`
  double active_s_ = 0;        // of the plan's own time
  double ended_since_s_ = -1;  // when it first looked ended; -1: it does not
};

}  // namespace sandwright
