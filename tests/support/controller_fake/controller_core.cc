#include "tests/support/controller_fake/controller_core.h"

#include <algorithm>

#include "tests/support/controller_fake/primary_packets.h"

namespace sandwright::fake {
namespace {

// How fast a pause and a safety stop take the motion's time away [1/s].
constexpr double kPauseRate = 4, kSafetyRate = 8;
constexpr double kProgramEndStop_radps2 = 8, kEmergencyStop_radps2 = 20;
constexpr int kProtectiveStopCode = 153, kNotRunningCode = 55;

}  // namespace

ControllerCore::ControllerCore(const ControllerFakeOptions& options)
    : options_(options),
      arm_(options.dh, options.start),
      machine_{.state = state_, .arm = arm_, .popup = {}, .watchdogs = {}, .sockets = {},
               .say = {}, .show = {}, .protect = {}},
      wanted_mode_(options.powered ? RobotMode::kRunning : RobotMode::kPowerOff) {
  state_.time_s = options.time_offset_s;
  state_.robot_mode = options.boot_delay_s > 0 ? RobotMode::kBooting : wanted_mode_;
  if (options.boot_delay_s > 0) next_mode_s_ = state_.time_s + options.boot_delay_s;
  state_.speed_slider = options.speed_slider;
  state_.X_FT = options.X_FT;
  state_.payload_kg = options.payload_kg;
  state_.payload_cog_m = options.payload_cog_m;
  arm_.SetTcp(options.X_FT);
  machine_.say = [this](const std::string& text) {
    messages_.push_back(text);
    packets_.push_back({state_.time_s, TextPacket(state_.time_s, text)});
  };
  machine_.show = [this](const Popup& popup) {
    popup_begin_s_ = state_.time_s;
    packets_.push_back({state_.time_s, PopupPacket(state_.time_s, popup.title, popup.text,
                                                   popup.warning, popup.error)});
  };
  machine_.protect = [this](const std::string& why) { ProtectiveStop(why); };
  UpdateState();
}

std::vector<std::string> ControllerCore::TakePackets() {
  std::vector<std::string> due;
  std::erase_if(packets_, [&](const DuePacket& packet) {
    if (packet.at_s > state_.time_s) return false;
    due.push_back(packet.bytes);
    return true;
  });
  return due;
}

void ControllerCore::SendKey(const std::string& title, const std::string& text) {
  if (key_faults_.swallow) return;
  packets_.push_back(
      {state_.time_s + key_faults_.delay_s, KeyPacket(state_.time_s, title, text)});
}

void ControllerCore::Report(const ScriptFault& fault) {
  last_fault_ = fault;
  packets_.push_back({state_.time_s, RuntimeExceptionPacket(state_.time_s, fault.line,
                                                            fault.column, fault.text)});
}

void ControllerCore::Upload(const std::string& text) {
  scripts_.push_back(text);
  if (reject_) return Report({1, 1, "syntax error: rejected"});
  if (!state_.MayMove()) {
    packets_.push_back({state_.time_s, ErrorCodePacket(state_.time_s, kNotRunningCode, 0,
                                                       ReportLevel::kViolation,
                                                       "the robot is not in running mode")});
    return;
  }
  if (const auto fault = FindLayoutFault(text, options_.strict_scripts)) return Report(*fault);
  try {
    Begin(ParseScript(text, options_.strict_scripts));
  } catch (const SyntaxError& error) {
    Report(error.fault);
  }
}

void ControllerCore::Begin(ScriptProgram program) {
  if (program.secondary) {
    secondary_ = std::make_unique<ScriptRunner>(machine_, std::move(program));
    return;
  }
  EndProgram();
  if (!stopping_.empty()) SendKey("PROGRAM_XXX_STOPPED", std::exchange(stopping_, ""));
  last_fault_.reset();
  trace_.clear();
  state_.program = program.name;
  state_.runtime = RuntimeState::kPlaying;
  SendKey("PROGRAM_XXX_STARTED", program.name);
  runner_ = std::make_unique<ScriptRunner>(machine_, std::move(program));
}

void ControllerCore::EndProgram() {
  if (!runner_) return;
  runner_->Stop();
  if (runner_->fault()) Report(*runner_->fault());
  stopping_ = runner_->program().name;
  runner_.reset();
  machine_.watchdogs.clear();
  machine_.sockets.clear();
  machine_.popup.reset();
  arm_.Stop(kProgramEndStop_radps2);
  state_.runtime = RuntimeState::kStopping;
}

bool ControllerCore::Load(const std::string& stored_program) {
  if (!options_.stored_programs.contains(stored_program)) return false;
  loaded_ = stored_program;
  return true;
}

bool ControllerCore::Play() {
  if (!state_.MayMove()) return false;
  if (state_.runtime == RuntimeState::kPaused || state_.runtime == RuntimeState::kPausing) {
    state_.runtime = RuntimeState::kResuming;
    return true;
  }
  if (runner_ || loaded_.empty()) return false;
  Upload(options_.stored_programs.at(loaded_));
  return true;
}

bool ControllerCore::Pause() {
  if (!runner_ || state_.runtime == RuntimeState::kPaused) return false;
  state_.runtime = RuntimeState::kPausing;
  return true;
}

bool ControllerCore::StopProgram() {
  if (!runner_) return false;
  EndProgram();
  return true;
}

bool ControllerCore::PowerOn() {
  if (state_.EmergencyStopped() || state_.robot_mode != RobotMode::kPowerOff) return false;
  wanted_mode_ = RobotMode::kIdle;
  next_mode_s_ = state_.time_s + options_.power_delay_s;
  return true;
}

void ControllerCore::PowerOff() {
  EndProgram();
  wanted_mode_ = state_.robot_mode = RobotMode::kPowerOff;
  next_mode_s_.reset();
}

bool ControllerCore::BrakeRelease() {
  if (state_.EmergencyStopped() || state_.robot_mode == RobotMode::kBooting) return false;
  wanted_mode_ = RobotMode::kRunning;
  next_mode_s_ = state_.time_s + options_.power_delay_s;
  return true;
}

bool ControllerCore::UnlockProtectiveStop() {
  if (state_.safety_mode != SafetyMode::kProtectiveStop) return false;
  SetSafety(SafetyMode::kNormal);
  return true;
}

void ControllerCore::AnswerPopup(bool go_on) {
  if (!machine_.popup) return;
  machine_.popup.reset();
  if (!go_on) EndProgram();
}

void ControllerCore::SetSlider(double fraction) {
  state_.speed_slider = std::clamp(fraction, 0.0, 1.0);
}

void ControllerCore::SetSafety(SafetyMode mode) {
  if (state_.safety_mode == mode) return;
  state_.safety_mode = mode;
  packets_.push_back({state_.time_s, SafetyModePacket(state_.time_s, mode)});
}

void ControllerCore::EmergencyStop(bool pressed) {
  if (!pressed) return SetSafety(SafetyMode::kNormal);
  SetSafety(SafetyMode::kRobotEmergencyStop);
  EndProgram();
  arm_.Stop(kEmergencyStop_radps2);
  wanted_mode_ = RobotMode::kPowerOff;
  next_mode_s_ = state_.time_s + options_.power_delay_s;
}

void ControllerCore::SafeguardStop(bool active) {
  if (active) {
    SetSafety(SafetyMode::kSafeguardStop);
    safeguard_paused_ = state_.runtime == RuntimeState::kPlaying && Pause();
  } else if (state_.safety_mode == SafetyMode::kSafeguardStop) {
    SetSafety(SafetyMode::kNormal);
    if (options_.safeguard_resumes && safeguard_paused_ && runner_) Play();
  }
}

void ControllerCore::ProtectiveStop(const std::string& why) {
  SetSafety(SafetyMode::kProtectiveStop);
  packets_.push_back({state_.time_s, ErrorCodePacket(state_.time_s, kProtectiveStopCode, 0,
                                                     ReportLevel::kViolation, why)});
  Pause();
}

void ControllerCore::ForceSpike(double newton, double duration_s) {
  spike_N_ = newton;
  spike_end_s_ = state_.time_s + duration_s;
}

void ControllerCore::UpdateModes() {
  if (!next_mode_s_ || state_.time_s < *next_mode_s_) return;
  next_mode_s_.reset();
  if (wanted_mode_ <= state_.robot_mode || state_.robot_mode < RobotMode::kPowerOff) {
    state_.robot_mode = wanted_mode_;
    return;
  }
  switch (state_.robot_mode) {
    case RobotMode::kPowerOff: state_.robot_mode = RobotMode::kPowerOn; break;
    case RobotMode::kPowerOn: state_.robot_mode = RobotMode::kIdle; break;
    default: state_.robot_mode = wanted_mode_;
  }
  if (state_.robot_mode != wanted_mode_) next_mode_s_ = state_.time_s + options_.power_delay_s;
}

void ControllerCore::UpdateScale() {
  const bool goes = state_.MayMove() && (state_.runtime == RuntimeState::kPlaying ||
                                         state_.runtime == RuntimeState::kResuming);
  const double wanted = goes ? state_.speed_slider : 0;
  const double step = (state_.MayMove() ? kPauseRate : kSafetyRate) * kControlPeriod_s;
  // An arm at rest takes the slider's value at once.
  scale_ = goes && arm_.AtRest() ? wanted : scale_ + std::clamp(wanted - scale_, -step, step);
  if (state_.runtime == RuntimeState::kPausing && scale_ <= 0)
    state_.runtime = RuntimeState::kPaused;
  if (state_.runtime == RuntimeState::kResuming) state_.runtime = RuntimeState::kPlaying;
}

void ControllerCore::UpdateWatchdogs() {
  for (const auto& [input, watchdog] : machine_.watchdogs) {
    const auto written = state_.input_written_s.find(input);
    const double last_s = std::max(
        watchdog.begun_s, written == state_.input_written_s.end() ? 0.0 : written->second);
    if (state_.time_s - last_s <= watchdog.longest_pause_s) continue;
    if (watchdog.action == "stop") return EndProgram();
    if (watchdog.action == "pause") Pause();
  }
}

void ControllerCore::RunProgram() {
  if (machine_.popup && options_.popup_answer_s &&
      state_.time_s - popup_begin_s_ >= *options_.popup_answer_s)
    machine_.popup.reset();
  if (secondary_) {
    secondary_->Turn();
    if (secondary_->fault()) Report(*secondary_->fault());
    if (secondary_->finished()) secondary_.reset();
  }
  if (!runner_ || state_.runtime != RuntimeState::kPlaying || !state_.MayMove()) return;
  runner_->Turn();
  // Speeds and servo targets hold only while the program renews them.
  if (!runner_->ArmClaimed() && arm_.Driven() && !arm_.OnPath()) arm_.Stop(kProgramEndStop_radps2);
  if (runner_->finished()) EndProgram();
}

void ControllerCore::Tick() {
  state_.time_s += kControlPeriod_s;
  UpdateModes();
  UpdateWatchdogs();
  UpdateScale();
  arm_.BeginPeriod(scale_);
  if (const auto fault = arm_.TakeFault()) ProtectiveStop(*fault);
  RunProgram();
  arm_.EndPeriod();
  if (state_.runtime == RuntimeState::kStopping && arm_.AtRest()) {
    state_.runtime = RuntimeState::kStopped;
    SendKey("PROGRAM_XXX_STOPPED", std::exchange(stopping_, ""));
  }
  UpdateState();
}

void ControllerCore::UpdateState() {
  // The trajectory limiter's share, without the slider's: a client multiplies the two.
  state_.speed_scaling = state_.ProgramAlive() && state_.speed_slider > 0
                             ? std::min(scale_ / state_.speed_slider, 1.0)
                             : 1;
  state_.q = arm_.q();
  state_.qdd_radps2 = (arm_.qd_radps() - state_.qd_radps) / kControlPeriod_s;
  state_.qd_radps = arm_.qd_radps();
  const Eigen::Isometry3d X_WF = arm_.kinematics().Forward(state_.q);
  state_.X_WT = X_WF * state_.X_FT;
  state_.tcp_speed = arm_.kinematics().Jacobian(state_.q) * state_.qd_radps;
  const Eigen::Vector3d lever = X_WF.linear() * state_.X_FT.translation();
  state_.tcp_speed.head<3>() += Eigen::Vector3d(state_.tcp_speed.tail<3>()).cross(lever);
  state_.tcp_force = options_.tcp_force;
  if (state_.time_s < spike_end_s_) state_.tcp_force.x() += spike_N_;
  if (state_.ProgramAlive() || state_.runtime == RuntimeState::kStopping)
    trace_.push_back({state_.time_s, state_.q, state_.output_int[0]});
}

}  // namespace sandwright::fake
