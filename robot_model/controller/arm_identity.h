// Which arm answers, and whether it is the one that a workcell is about.
#pragma once

#include <string>
#include <vector>

#include "robot_model/controller/dashboard_client.h"
#include "robot_model/controller/primary_client.h"
#include "robot_model/controller/rtde_client.h"
#include "robot_model/workcell.h"

namespace sandwright {

struct ControllerAddress {
  std::string host;
  uint16_t dashboard_port = 29999, primary_port = 30001, rtde_port = 30004;
};

struct ArmIdentity {
  std::string model, serial_number;  // as the dashboard tells
  ControllerVersion version;         // of PolyScope
  RobotMode robot_mode = RobotMode::kDisconnected;
  SafetyMode safety_mode = SafetyMode::kFault;
  std::string program_state;  // STOPPED, PLAYING, PAUSED
  DhParameters kinematics;    // the factory calibration
};

// Throws Error (kRefused) with the reason for an address beyond this machine that was not armed.
// A CB3 has no switch for remote control and its ssh login is published: whoever reaches it can
// move it, and so must mean to.
void CheckArmed(const ControllerAddress& address, bool armed);

// Asks over connections that stand. Throws Error where an answer is missing.
ArmIdentity ReadIdentity(DashboardClient& dashboard, const PrimaryClient& primary,
                         const RtdeClient& rtde);
// The same over connections of its own, which it closes; for reading the calibration of an arm that
// the workcell does not match yet.
ArmIdentity ReadIdentity(const ControllerAddress& address, bool armed);

// Why no program of this workcell may be sent to that arm; empty where it may: model UR10, version
// of RtdeClient's range, calibration bit for bit that of the workcell, RUNNING, NORMAL or REDUCED,
// no program running or paused.
std::vector<std::string> IdentityFaults(const ArmIdentity& arm, const Workcell& workcell);

}  // namespace sandwright
