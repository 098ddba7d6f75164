#include "robot_model/controller/arm_identity.h"

#include <spdlog/fmt/fmt.h>

#include "data/base/error.h"

namespace sandwright {
namespace {

std::string RowText(const char* key, const std::vector<double>& row) {
  return fmt::format("{} [{}]", key, fmt::join(row, ", "));
}

std::string DhText(const DhParameters& dh) {
  return RowText("a_m", dh.a_m) + ", " + RowText("d_m", dh.d_m) + ", " +
         RowText("alpha_rad", dh.alpha_rad) + ", " + RowText("theta_rad", dh.theta_rad);
}

}  // namespace

void CheckArmed(const ControllerAddress& address, bool armed) {
  if (armed || IsLoopback(address.host)) return;
  throw Error(
      "controller " + address.host,
      {"not armed: an address other than this machine must be armed explicitly",
       "a CB3 has no switch for remote control and its ssh login is published, so that everybody "
       "on its network can move it: connect it by a cable of its own, to nothing else"});
}

ArmIdentity ReadIdentity(DashboardClient& dashboard, const PrimaryClient& primary,
                         const RtdeClient& rtde) {
  ArmIdentity arm;
  arm.model = dashboard.AskRobotModel();
  arm.serial_number = dashboard.AskSerialNumber();
  arm.version = dashboard.AskPolyscopeVersion();
  arm.robot_mode = dashboard.AskRobotMode();
  arm.safety_mode = dashboard.AskSafetyMode();
  arm.program_state = dashboard.AskProgramState();
  // Programs that were sent as text are told by this line and by RTDE, not always by the one above.
  if (arm.program_state == "STOPPED" &&
      (dashboard.AskProgramRunning() || !rtde.latest().state.is_stopped()))
    arm.program_state = Name(rtde.latest().state.runtime_state) + " (a script)";
  arm.kinematics = primary.kinematics().dh;
  return arm;
}

ArmIdentity ReadIdentity(const ControllerAddress& address, bool armed) {
  CheckArmed(address, armed);
  DashboardClient dashboard(address.host, address.dashboard_port);
  const PrimaryClient primary(address.host, address.primary_port);
  const RtdeClient rtde(address.host, address.rtde_port);
  return ReadIdentity(dashboard, primary, rtde);
}

std::vector<std::string> IdentityFaults(const ArmIdentity& arm, const Workcell& workcell) {
  std::vector<std::string> faults;
  if (arm.model != "UR10")
    faults.push_back(fmt::format("the arm is a '{}'; allowed: UR10 (CB3)", arm.model));
  if (arm.version < RtdeClient::kOldest || arm.version >= RtdeClient::kBeyond)
    faults.push_back(fmt::format("PolyScope {}; allowed: {} up to, without, {}", Name(arm.version),
                                 Name(RtdeClient::kOldest), Name(RtdeClient::kBeyond)));
  Workcell calibrated = workcell;
  calibrated.kinematics = arm.kinematics;
  const std::string of_arm = CalibrationHash(calibrated), of_cell = CalibrationHash(workcell);
  if (of_arm != of_cell)
    faults.push_back(fmt::format(
        "the calibration of arm {} is {}... ({}), the workcell's {}... ({}); read it into the "
        "workcell, look at it, and plan anew",
        arm.serial_number, of_arm.substr(0, 12), DhText(arm.kinematics), of_cell.substr(0, 12),
        DhText(workcell.kinematics)));
  if (arm.robot_mode != RobotMode::kRunning)
    faults.push_back(fmt::format("robot mode {}; allowed: RUNNING (power and brakes are a person's "
                                 "to switch, at the pendant)",
                                 Name(arm.robot_mode)));
  if (arm.safety_mode != SafetyMode::kNormal && arm.safety_mode != SafetyMode::kReduced)
    faults.push_back(fmt::format("safety mode {}; allowed: NORMAL, REDUCED (find the cause and "
                                 "release it at the pendant)",
                                 Name(arm.safety_mode)));
  if (arm.program_state != "STOPPED")
    faults.push_back(fmt::format("a program is there: {}; end it first", arm.program_state));
  return faults;
}

}  // namespace sandwright
