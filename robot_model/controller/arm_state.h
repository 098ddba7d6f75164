// What a controller reports of its arm, 125 times a second.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "robot_model/ur10.h"

namespace sandwright {

// Values that are none of these are kept as they are and count as unfit to move.
enum class RobotMode : int32_t {
  kNoController = -1,
  kDisconnected = 0,
  kConfirmSafety = 1,
  kBooting = 2,
  kPowerOff = 3,
  kPowerOn = 4,
  kIdle = 5,
  kBackdrive = 6,
  kRunning = 7,
  kUpdatingFirmware = 8,
};

enum class SafetyMode : int32_t {
  kNormal = 1,
  kReduced = 2,
  kProtectiveStop = 3,
  kRecovery = 4,
  kSafeguardStop = 5,
  kSystemEmergencyStop = 6,
  kRobotEmergencyStop = 7,
  kViolation = 8,
  kFault = 9,
};

enum class RuntimeState : uint32_t {
  kStopping = 0,
  kStopped = 1,
  kPlaying = 2,
  kPausing = 3,
  kPaused = 4,
  kResuming = 5,
};

// As the dashboard writes them ("POWER_OFF"); other values as "mode 42".
std::string Name(RobotMode mode);
std::string Name(SafetyMode mode);
std::string Name(RuntimeState state);

// One frame of the controller. Poses and forces are of the installation's TCP in the base frame W.
struct ArmState {
  double timestamp_s = 0;  // since the controller was started
  JointAngles target_q, actual_q;
  Vector6 actual_qd_radps = Vector6::Zero();
  Vector6 tcp_pose = Vector6::Zero();   // m, then rotation vector [rad]
  Vector6 tcp_speed = Vector6::Zero();  // m/s, rad/s
  Vector6 tcp_force = Vector6::Zero();  // N, Nm: estimated from joint currents, never zeroed
  double speed_scaling = 0;             // of the trajectory limiter, 0..1
  double target_speed_fraction = 0;     // the speed slider, 0..1
  RuntimeState runtime_state = RuntimeState::kStopped;
  RobotMode robot_mode = RobotMode::kDisconnected;
  SafetyMode safety_mode = SafetyMode::kFault;
  uint32_t robot_status_bits = 0;   // 0 power, 1 program running, 2 teach button, 3 power button
  uint32_t safety_status_bits = 0;  // the constants below
  std::array<int32_t, 3> output_registers = {};

  static constexpr uint32_t kSafetyProtective = 1u << 2, kSafetyRecovery = 1u << 3,
                            kSafetySafeguard = 1u << 4, kSafetyEmergency = 7u << 5,
                            kSafetyFaults = 3u << 8;

  bool is_fit_to_move() const {
    return robot_mode == RobotMode::kRunning &&
           (safety_mode == SafetyMode::kNormal || safety_mode == SafetyMode::kReduced);
  }
  // A program is neither running nor paused.
  bool is_stopped() const { return runtime_state == RuntimeState::kStopped; }
};

}  // namespace sandwright
