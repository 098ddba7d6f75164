#include "robot_model/controller/arm_state.h"

namespace sandwright {

std::string Name(RobotMode mode) {
  switch (mode) {
    case RobotMode::kNoController: return "NO_CONTROLLER";
    case RobotMode::kDisconnected: return "DISCONNECTED";
    case RobotMode::kConfirmSafety: return "CONFIRM_SAFETY";
    case RobotMode::kBooting: return "BOOTING";
    case RobotMode::kPowerOff: return "POWER_OFF";
    case RobotMode::kPowerOn: return "POWER_ON";
    case RobotMode::kIdle: return "IDLE";
    case RobotMode::kBackdrive: return "BACKDRIVE";
    case RobotMode::kRunning: return "RUNNING";
    case RobotMode::kUpdatingFirmware: return "UPDATING_FIRMWARE";
  }
  return "mode " + std::to_string(static_cast<int32_t>(mode));
}

std::string Name(SafetyMode mode) {
  switch (mode) {
    case SafetyMode::kNormal: return "NORMAL";
    case SafetyMode::kReduced: return "REDUCED";
    case SafetyMode::kProtectiveStop: return "PROTECTIVE_STOP";
    case SafetyMode::kRecovery: return "RECOVERY";
    case SafetyMode::kSafeguardStop: return "SAFEGUARD_STOP";
    case SafetyMode::kSystemEmergencyStop: return "SYSTEM_EMERGENCY_STOP";
    case SafetyMode::kRobotEmergencyStop: return "ROBOT_EMERGENCY_STOP";
    case SafetyMode::kViolation: return "VIOLATION";
    case SafetyMode::kFault: return "FAULT";
  }
  return "mode " + std::to_string(static_cast<int32_t>(mode));
}

std::string Name(RuntimeState state) {
  switch (state) {
    case RuntimeState::kStopping: return "STOPPING";
    case RuntimeState::kStopped: return "STOPPED";
    case RuntimeState::kPlaying: return "PLAYING";
    case RuntimeState::kPausing: return "PAUSING";
    case RuntimeState::kPaused: return "PAUSED";
    case RuntimeState::kResuming: return "RESUMING";
  }
  return "state " + std::to_string(static_cast<uint32_t>(state));
}

}  // namespace sandwright
