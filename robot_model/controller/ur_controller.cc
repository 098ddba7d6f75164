#include "robot_model/controller/ur_controller.h"

#include <spdlog/fmt/fmt.h>

#include "data/base/error.h"
#include "data/base/stop.h"
#include "robot_model/controller/script_rules.h"

namespace sandwright {
namespace {

using namespace std::chrono_literals;

constexpr int32_t kGoOn = 0, kStop = 1;  // ProgramRegisters::kCommand
constexpr auto kFrameTime = 20ms;
// The program has this long to confirm a stop before the dashboard is asked, and the arm this long
// to stand.
constexpr std::chrono::milliseconds kConfirmTime = 100ms, kStandTime = 3s;
constexpr double kStanding_radps = 0.01;
// Errors may follow the end of a program.
constexpr auto kDrainTime = 100ms;
// Beats that are under way before the program is sent.
constexpr int kBeatsBefore = 3;

const ControllerAddress& Armed(const ControllerAddress& address, bool armed) {
  CheckArmed(address, armed);
  return address;
}

bool IsStanding(const ArmState& state) {
  return state.actual_qd_radps.cwiseAbs().maxCoeff() < kStanding_radps;
}

// A stop of the safety system is the cause of what was seen first on another connection, and goes
// on record beside any other cause.
void Explain(const RunVerdict& safety, RunOutcome& outcome) {
  if (outcome.end == safety.end) return;
  outcome.reason += "; " + safety.reason;
  if (outcome.end == RunEnd::kControllerError || outcome.end == RunEnd::kProgramEnded)
    outcome.end = safety.end;
}

}  // namespace

RunPlan PlanOfRun(const ArmProgram& program) {
  const GatedMotion& motion = program.motion();
  RunPlan plan{program.name(), motion.knots(), motion.knots().size(), motion.knots().size(),
               program.duration_s()};
  if (motion.kind() == GatedMotion::Kind::kStroke) {
    plan.stroke_begin = motion.stroke_begin();
    plan.path_begin = plan.stroke_begin + motion.stroke_motion().path_begin;
  }
  return plan;
}

// Keeps every sample and hands it on; what the observer throws becomes a verdict.
class UrController::Recorder {
 public:
  Recorder(std::vector<RunSample>& samples, const Observer& observer)
      : samples_(samples), observer_(observer) {}

  void Take(RunSample sample) {
    samples_.push_back(std::move(sample));
    if (!observer_ || failure_) return;
    try {
      observer_(samples_.back());
    } catch (const std::exception& error) {
      failure_ = RunVerdict{RunEnd::kInternalFault, fmt::format("observer: {}", error.what())};
    } catch (...) {
      failure_ = RunVerdict{RunEnd::kInternalFault, "observer: unknown exception"};
    }
  }
  const std::optional<RunVerdict>& failure() const { return failure_; }

 private:
  std::vector<RunSample>& samples_;
  const Observer& observer_;
  std::optional<RunVerdict> failure_;
};

UrController::UrController(const ControllerAddress& address, const Workcell& workcell, bool armed)
    : workcell_(workcell),
      dashboard_(Armed(address, armed).host, address.dashboard_port),
      primary_(address.host, address.primary_port),
      rtde_(address.host, address.rtde_port),
      identity_(ReadIdentity(dashboard_, primary_, rtde_)) {
  const auto faults = IdentityFaults(identity_, workcell_);
  if (!faults.empty()) throw Error("controller " + address.host, faults);
}

std::optional<RunVerdict> UrController::LostLink() const {
  if (rtde_.link() != LinkState::kOpen)
    return RunVerdict{RunEnd::kLinkLost, fmt::format("RTDE is {}", Name(rtde_.link()))};
  if (primary_.link() != LinkState::kOpen)
    return RunVerdict{RunEnd::kLinkLost,
                      fmt::format("the primary interface is {}", Name(primary_.link()))};
  if (rtde_.freshness() != Freshness::kFresh)
    return RunVerdict{RunEnd::kLinkLost, fmt::format("no news of the arm for {} ms",
                                                     RtdeClient::kStaleAfter / 1ms)};
  return std::nullopt;
}

std::optional<RunVerdict> UrController::WhyNotNow(const ArmProgram& program) const {
  if (fault_)
    return RunVerdict{RunEnd::kRefused,
                      fmt::format("after {} ({}); connect anew", Name(fault_->end),
                                  fault_->reason)};
  if (stop_asked_ || StopRequested())
    return RunVerdict{RunEnd::kStoppedByOperator, "before the program was sent"};
  if (auto lost = LostLink()) return lost;
  const ArmState state = rtde_.latest().state;
  if (auto verdict = SafetyVerdict(state)) return verdict;
  if (!state.is_stopped())
    return RunVerdict{RunEnd::kRefused,
                      fmt::format("another program is {}", Name(state.runtime_state))};
  ArmIdentity now = identity_;
  now.kinematics = primary_.kinematics().dh;
  if (const auto faults = IdentityFaults(now, workcell_); !faults.empty())
    return RunVerdict{RunEnd::kRefused, faults.front()};
  const Vector6 off = (state.actual_q.rad - program.motion().start().rad).cwiseAbs();
  int joint = 0;
  if (off.maxCoeff(&joint) > kStartTolerance_rad)
    return RunVerdict{RunEnd::kNotAtStart,
                      fmt::format("joint {} is {:.3f} rad from the motion's start; allowed: {}",
                                  joint + 1, off[joint], kStartTolerance_rad)};
  if (!IsStanding(state)) return RunVerdict{RunEnd::kRefused, "the arm is moving"};
  if (const auto faults = ScriptFaults(program.text(), program.name()); !faults.empty())
    return RunVerdict{RunEnd::kScriptError, faults.front()};
  return std::nullopt;
}

RunOutcome UrController::Run(const ArmProgram& program, const Observer& observer,
                             const ForceBaseline& baseline) {
  RunOutcome outcome;
  const int gaps = rtde_.gaps(), lost_frames = rtde_.lost_frames();
  RunVerdict verdict;
  if (auto why = WhyNotNow(program)) {
    verdict = *why;
    outcome.end = verdict.end;
    outcome.reason = verdict.reason;
  } else {
    RunWatch watch(PlanOfRun(program), workcell_.limits, baseline, latest());
    Recorder recorder(outcome.samples, observer);
    try {
      verdict = SendAndWatch(program, watch, recorder);
    } catch (const std::exception& error) {
      verdict = {RunEnd::kInternalFault, error.what()};
    }
    outcome.end = verdict.end;
    outcome.reason = verdict.reason;
    if (outcome.end != RunEnd::kFinished) StopArm(watch, recorder, outcome);
  }
  outcome.gaps = rtde_.gaps() - gaps;
  outcome.lost_frames = rtde_.lost_frames() - lost_frames;
  // The first fault stays: later ones only repeat that there was one.
  if (outcome.end != RunEnd::kFinished && !fault_) fault_ = {outcome.end, outcome.reason};
  return outcome;
}

std::optional<ArmFrame> UrController::Next(RunWatch& watch, Clock::time_point deadline) {
  const auto frame = rtde_.TakeFrame(deadline);
  while (const auto event = primary_.TakeEvent()) watch.Take(*event);
  return frame;
}

RunVerdict UrController::SendAndWatch(const ArmProgram& program, RunWatch& watch,
                                      Recorder& recorder) {
  primary_.ClearEvents();
  rtde_.ClearFrames();
  if (!rtde_.SendCommand(kGoOn)) return {RunEnd::kLinkLost, "RTDE takes no inputs"};
  for (int beat = 0; beat < kBeatsBefore; ++beat)
    if (!rtde_.TakeFrame(Clock::now() + RtdeClient::kStaleAfter))
      return {RunEnd::kLinkLost, "no news of the arm before the program was sent"};
  if (!primary_.SendScript(program.text(), program.name()))
    return {RunEnd::kLinkLost, "the program could not be sent whole"};
  std::optional<Clock::time_point> finished_at;
  for (;;) {
    if (stop_asked_ || StopRequested())
      return {RunEnd::kStoppedByOperator, "asked for at the computer"};
    if (recorder.failure()) return *recorder.failure();
    const auto frame = Next(watch, Clock::now() + kFrameTime);
    if (frame) recorder.Take(watch.Take(frame->state));
    const auto verdict = watch.Judge();
    if (verdict && verdict->end != RunEnd::kFinished) return *verdict;
    if (!verdict) {
      if (auto lost = LostLink()) return *lost;
      continue;
    }
    if (!finished_at) finished_at = Clock::now();
    if (Clock::now() - *finished_at > kDrainTime) return *verdict;
  }
}

void UrController::StopArm(RunWatch& watch, Recorder& recorder, RunOutcome& outcome) {
  const auto decided = Clock::now();
  rtde_.SendCommand(kStop);
  // Somebody else's program is not ours to stop; ours is gone.
  const bool is_foreign = outcome.end == RunEnd::kForeignProgram;
  // A program that has not started may still be on its way and cannot confirm anything.
  const bool ask_at_once = outcome.end == RunEnd::kDidNotStart;
  bool asked = is_foreign, dashboard_confirms = false;
  std::optional<RunVerdict> safety;
  while (Clock::now() - decided < kStandTime) {
    const bool is_blind =
        rtde_.link() != LinkState::kOpen || rtde_.freshness() == Freshness::kDead;
    if (const auto frame = Next(watch, Clock::now() + kFrameTime)) {
      recorder.Take(watch.Take(frame->state));
      if (!safety) safety = SafetyVerdict(frame->state);
      const bool stands = IsStanding(frame->state) && frame->state.is_stopped();
      // A frame that had been waiting tells of the time before the decision.
      if (stands && !outcome.stop_latency_s && frame->arrival >= decided)
        outcome.stop_latency_s = std::chrono::duration<double>(frame->arrival - decided).count();
    }
    const auto waited = Clock::now() - decided;
    const bool is_over = watch.program_over() && rtde_.freshness() == Freshness::kFresh;
    if (!asked && (is_blind || ask_at_once || (!is_over && waited > kConfirmTime))) {
      asked = true;
      dashboard_confirms = dashboard_.Stop();
    }
    // What the safety system says may come a little behind what it caused.
    if (waited > kDrainTime && (outcome.stop_latency_s || is_foreign)) break;
    if (is_blind) break;
  }
  if (safety) Explain(*safety, outcome);
  if (outcome.stop_latency_s || is_foreign) return;
  outcome.reason += dashboard_confirms
                        ? "; the dashboard confirms the stop, the arm was not seen to stand"
                        : "; THE STOP IS NOT CONFIRMED: press the emergency stop";
}

}  // namespace sandwright
