// A UR10 (CB3) behind its three connections: sends one program at a time and watches it.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <vector>

#include "robot_model/arm_program.h"
#include "robot_model/controller/arm_identity.h"
#include "robot_model/controller/run_watch.h"

namespace sandwright {

struct RunOutcome {
  RunEnd end = RunEnd::kFinished;
  std::string reason;  // with figures; says so where the arm did not confirm a stop
  // From the decision to stop to the arm standing still without a program; none where it finished
  // by itself or was not seen to stand.
  std::optional<double> stop_latency_s;
  std::vector<RunSample> samples;    // every frame of the run and of the stop
  int gaps = 0, lost_frames = 0;     // of the frames on their way here
};

// Any end but kFinished is latched: nothing more is sent over this object. To go on is a person's
// decision, made by connecting anew. Nothing is ever sent twice, resumed, unlocked or powered.
class UrController {
 public:
  static constexpr double kStartTolerance_rad = 0.02;
  // Called in the run's own thread with every frame. The beat waits for it: one that takes longer
  // than some 50 ms stops the arm.
  using Observer = std::function<void(const RunSample&)>;

  // Connects, and refuses another arm than the workcell's or one that is not ready
  // (IdentityFaults): Error (kRefused) with all reasons; Error for what a connection lacks.
  // Addresses beyond this machine must be `armed` (CheckArmed).
  UrController(const ControllerAddress& address, const Workcell& workcell, bool armed = false);

  const ArmIdentity& identity() const { return identity_; }
  ArmState latest() const { return rtde_.latest().state; }
  // What was latched; none so far.
  const std::optional<RunVerdict>& fault() const { return fault_; }
  // For popups at the pendant, between runs.
  DashboardClient& dashboard() { return dashboard_; }

  // Sends the program and watches it to its end. Faults of arm, network and program are ends, not
  // exceptions. `baseline`: of the same stroke in the air (ForceGuard); empty without.
  RunOutcome Run(const ArmProgram& program, const Observer& observer = {},
                 const ForceBaseline& baseline = {});
  // Ends a run that is under way, and forbids others; for any thread.
  void Stop() { stop_asked_ = true; }

 private:
  class Recorder;
  std::optional<RunVerdict> WhyNotNow(const ArmProgram& program) const;
  RunVerdict SendAndWatch(const ArmProgram& program, RunWatch& watch, Recorder& recorder);
  void StopArm(RunWatch& watch, Recorder& recorder, RunOutcome& outcome);
  std::optional<RunVerdict> LostLink() const;
  // The next frame by `deadline`, with the events that came until then.
  std::optional<ArmFrame> Next(RunWatch& watch, Clock::time_point deadline);

  Workcell workcell_;
  DashboardClient dashboard_;
  PrimaryClient primary_;
  RtdeClient rtde_;
  ArmIdentity identity_;
  std::optional<RunVerdict> fault_;
  std::atomic<bool> stop_asked_ = false;
};

// What a run of `program` is watched against.
RunPlan PlanOfRun(const ArmProgram& program);

}  // namespace sandwright
