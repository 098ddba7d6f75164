#include "robot_model/controller/run_watch.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "robot_model/arm_program.h"

namespace sandwright {
namespace {

// The three signs of the end come on two connections.
constexpr double kAgreementTime_s = 0.5;

}  // namespace

std::optional<RunVerdict> SafetyVerdict(const ArmState& state) {
  const uint32_t bits = state.safety_status_bits;
  const SafetyMode mode = state.safety_mode;
  const std::string reason =
      fmt::format("safety mode {}, robot mode {}", Name(mode), Name(state.robot_mode));
  if (mode == SafetyMode::kViolation || mode == SafetyMode::kFault ||
      bits & ArmState::kSafetyFaults)
    return RunVerdict{RunEnd::kSafetyFault, reason};
  if (mode == SafetyMode::kSystemEmergencyStop || mode == SafetyMode::kRobotEmergencyStop ||
      bits & ArmState::kSafetyEmergency)
    return RunVerdict{RunEnd::kEmergencyStop, reason};
  if (mode == SafetyMode::kProtectiveStop || bits & ArmState::kSafetyProtective)
    return RunVerdict{RunEnd::kProtectiveStop, reason};
  if (mode == SafetyMode::kSafeguardStop || bits & ArmState::kSafetySafeguard)
    return RunVerdict{RunEnd::kSafeguardStop, reason};
  if (!state.is_fit_to_move() || bits & ArmState::kSafetyRecovery)
    return RunVerdict{RunEnd::kSafetyFault, reason};
  return std::nullopt;
}

RunWatch::RunWatch(RunPlan plan, const MotionLimits& limits, ForceBaseline baseline,
                   const ArmState& before)
    : plan_(std::move(plan)),
      script_(plan_.name),
      force_(limits, std::move(baseline), plan_.stroke_begin, plan_.path_begin),
      progress_(plan_.knots),
      before_(before),
      state_(before) {}

int32_t RunWatch::phase() const { return state_.output_registers[ProgramRegisters::kPhase]; }

void RunWatch::Take(const PrimaryItem& item) {
  script_.Take(item);
  if (const auto* mode = std::get_if<RobotModeData>(&item)) mode_ = *mode;
}

RunSample RunWatch::Take(const ArmState& state) {
  const double step_s = state.timestamp_s - state_.timestamp_s;
  state_ = state;
  time_s_ = state.timestamp_s - before_.timestamp_s;
  // A pulse that stands still belongs to a program that is gone.
  if (phase() == static_cast<int32_t>(ProgramPhase::kRunning) &&
      state.output_registers[ProgramRegisters::kPulse] !=
          before_.output_registers[ProgramRegisters::kPulse])
    ran_ = true;
  if (ran_ && state.runtime_state == RuntimeState::kPlaying)
    active_s_ += step_s * std::clamp(state.speed_scaling * state.target_speed_fraction, 0.0, 1.0);
  progress_.Take(state.actual_q);
  force_.Take({progress_.knot(), state.tcp_force.head<3>()});
  if (!says_ended()) ended_since_s_ = -1;
  else if (ended_since_s_ < 0) ended_since_s_ = time_s_;
  return {state, time_s_, progress_.knot(), progress_.deviation_rad(), force_.contact_n()};
}

bool RunWatch::says_ended() const {
  return script_.stopped() || ((script_.started() || ran_) && state_.is_stopped());
}

bool RunWatch::program_over() const {
  const bool said_so = ran_ && phase() >= static_cast<int32_t>(ProgramPhase::kFinished);
  return said_so || script_.stopped() || script_.foreign() || state_.is_stopped();
}

std::optional<RunVerdict> RunWatch::Judge() const {
  if (auto verdict = JudgeSafety()) return verdict;
  if (auto verdict = JudgeScript()) return verdict;
  if (auto verdict = JudgePhase()) return verdict;
  if (auto verdict = JudgeMotion()) return verdict;
  return JudgeEnd();
}

std::optional<RunVerdict> RunWatch::JudgeSafety() const {
  if (auto verdict = SafetyVerdict(state_)) return verdict;
  if (mode_.is_emergency_stopped)
    return RunVerdict{RunEnd::kEmergencyStop, "reported by the primary interface"};
  if (mode_.is_protective_stopped)
    return RunVerdict{RunEnd::kProtectiveStop, "reported by the primary interface"};
  return std::nullopt;
}

std::optional<RunVerdict> RunWatch::JudgeScript() const {
  if (script_.exception()) return RunVerdict{RunEnd::kScriptError, *script_.exception()};
  if (script_.controller_error())
    return RunVerdict{RunEnd::kControllerError, *script_.controller_error()};
  if (script_.foreign())
    return RunVerdict{RunEnd::kForeignProgram,
                      fmt::format("program '{}' was started by somebody else", *script_.foreign())};
  return std::nullopt;
}

std::optional<RunVerdict> RunWatch::JudgePhase() const {
  const bool is_ours = ran_ || script_.stopped() ||
                       phase() != before_.output_registers[ProgramRegisters::kPhase];
  if (!is_ours) return std::nullopt;
  switch (static_cast<ProgramPhase>(phase())) {
    case ProgramPhase::kNotAtStart:
      return RunVerdict{RunEnd::kNotAtStart, "the program found the arm away from its start"};
    case ProgramPhase::kOtherTcp:
      return RunVerdict{RunEnd::kOtherTcp, "the installation's TCP is not the workcell's"};
    case ProgramPhase::kOtherPayload:
      return RunVerdict{RunEnd::kOtherPayload, "the installation's payload is not the workcell's"};
    case ProgramPhase::kBeatLost:
      return RunVerdict{RunEnd::kBeatLost, "the program heard nothing from the PC and stopped"};
    case ProgramPhase::kAskedToStop:
      return RunVerdict{RunEnd::kProgramEnded, "the program was asked to stop, not by this run"};
    case ProgramPhase::kIdle:
    case ProgramPhase::kRunning:
    case ProgramPhase::kFinished: break;
  }
  return std::nullopt;
}

std::optional<RunVerdict> RunWatch::JudgeMotion() const {
  if (force_.tripped())
    return RunVerdict{RunEnd::kForce,
                      fmt::format("contact of {:.0f} N at knot {} of {}; allowed: {:.0f} N",
                                  force_.contact_n(), progress_.knot(), plan_.knots.size(),
                                  force_.limit_n())};
  if (progress_.deviation_rad() > kLargestDeviation_rad)
    return RunVerdict{
        RunEnd::kLeftPlan,
        fmt::format("a joint is {:.3f} rad from the plan at knot {} of {}; allowed: {}",
                    progress_.deviation_rad(), progress_.knot(), plan_.knots.size(),
                    kLargestDeviation_rad)};
  return std::nullopt;
}

std::optional<RunVerdict> RunWatch::JudgeEnd() const {
  const bool says_finished = ran_ && phase() == static_cast<int32_t>(ProgramPhase::kFinished);
  if (script_.stopped() && says_finished && state_.is_stopped()) {
    const double off_rad = progress_.DistanceFromEnd_rad(state_.actual_q);
    if (off_rad > kEndTolerance_rad)
      return RunVerdict{RunEnd::kLeftPlan,
                        fmt::format("finished {:.3f} rad from the motion's end; allowed: {}",
                                    off_rad, kEndTolerance_rad)};
    return RunVerdict{RunEnd::kFinished, "finished"};
  }
  if (ended_since_s_ >= 0 && time_s_ - ended_since_s_ > kAgreementTime_s)
    return RunVerdict{
        RunEnd::kProgramEnded,
        fmt::format("ended without agreement: the controller says {}, the program is in phase {}, "
                    "the arm's state is {}",
                    script_.stopped() ? "stopped" : "not stopped", phase(),
                    Name(state_.runtime_state))};
  if (!ran_ && time_s_ > kStartTime_s)
    return RunVerdict{RunEnd::kDidNotStart,
                      fmt::format("not running {} s after it was sent", kStartTime_s)};
  const double longest_s = plan_.duration_s * kDurationShare + kDurationMore_s;
  if (active_s_ > longest_s)
    return RunVerdict{RunEnd::kTookTooLong,
                      fmt::format("moving for {:.1f} s of the plan's {:.1f} s; allowed: {:.1f} s",
                                  active_s_, plan_.duration_s, longest_s)};
  return std::nullopt;
}

}  // namespace sandwright
