// What the fake controller shows of itself: the numbers behind every frame it sends.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "robot_model/ur10.h"

namespace sandwright::fake {

inline constexpr double kControlPeriod_s = 0.008;
inline constexpr int kRegisters = 48;

enum class RobotMode {
  kNoController = -1,
  kDisconnected = 0,
  kConfirmSafety = 1,
  kBooting = 2,
  kPowerOff = 3,
  kPowerOn = 4,
  kIdle = 5,
  kBackdrive = 6,
  kRunning = 7,
};

enum class SafetyMode {
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

enum class RuntimeState {
  kStopping = 0,
  kStopped = 1,
  kPlaying = 2,
  kPausing = 3,
  kPaused = 4,
  kResuming = 5,
};

// What RTDE clients write.
struct InputRegisters {
  std::array<int32_t, kRegisters> ints{};
  std::array<double, kRegisters> doubles{};
  std::array<bool, 64> bits{};
};

struct ControllerState {
  double time_s = 0;  // since the controller was switched on
  RobotMode robot_mode = RobotMode::kRunning;
  SafetyMode safety_mode = SafetyMode::kNormal;
  RuntimeState runtime = RuntimeState::kStopped;
  std::string program;  // name of the last one started

  double speed_slider = 1;   // 0..1, target_speed_fraction
  double speed_scaling = 1;  // 0..1, on top of it: below 1 while a pause or a stop slows the arm

  JointAngles q;
  Vector6 qd_radps = Vector6::Zero(), qdd_radps2 = Vector6::Zero();
  Eigen::Isometry3d X_WT = Eigen::Isometry3d::Identity();
  Vector6 tcp_speed = Vector6::Zero();  // m/s, rad/s
  Vector6 tcp_force = Vector6::Zero();  // N, Nm

  Eigen::Isometry3d X_FT = Eigen::Isometry3d::Identity();
  double payload_kg = 0;
  Eigen::Vector3d payload_cog_m = Eigen::Vector3d::Zero();

  InputRegisters inputs;
  std::map<std::string, double> input_written_s;  // when each input was last written
  std::array<int32_t, kRegisters> output_int{};
  std::array<double, kRegisters> output_double{};
  std::array<bool, 64> output_bit{};
  uint64_t digital_inputs = 0, digital_outputs = 0;

  bool Powered() const { return robot_mode >= RobotMode::kPowerOn; }
  bool EmergencyStopped() const {
    return safety_mode == SafetyMode::kSystemEmergencyStop ||
           safety_mode == SafetyMode::kRobotEmergencyStop;
  }
  bool MayMove() const {
    return robot_mode == RobotMode::kRunning &&
           (safety_mode == SafetyMode::kNormal || safety_mode == SafetyMode::kReduced);
  }
  bool ProgramAlive() const {
    return runtime != RuntimeState::kStopped && runtime != RuntimeState::kStopping;
  }
};

// A pose as URScript and the wire write it: x, y, z [m], then rotation vector [rad].
Vector6 PoseVector(const Eigen::Isometry3d& X);
Eigen::Isometry3d PoseFromVector(const Vector6& pose);
Eigen::Vector3d RotationVector(const Eigen::Matrix3d& R);

}  // namespace sandwright::fake
