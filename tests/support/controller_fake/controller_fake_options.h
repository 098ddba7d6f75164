// What kind of controller the fake is.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "robot_model/ur10.h"

namespace sandwright {

// 0: any free one.
struct ControllerPorts {
  uint16_t dashboard = 0, primary = 0, secondary = 0, realtime = 0, rtde = 0;

  static ControllerPorts Standard() { return {29999, 30001, 30002, 30003, 30004}; }
};

struct ControllerFakeOptions {
  std::string address = "127.0.0.1";
  ControllerPorts ports;

  std::string model = "UR10", serial = "2017309999";
  std::array<uint32_t, 4> version = {3, 15, 8, 106339};
  DhParameters dh;
  JointAngles start{{-1.8476, -1.6540, 2.1158, -2.0326, -1.5708, -1.8476}};

  // The installation's, which holds until a program sets others.
  Eigen::Isometry3d X_FT = Eigen::Isometry3d(Eigen::Translation3d(0, 0, 0.250));
  double payload_kg = 2.2;
  Eigen::Vector3d payload_cog_m{0, 0, 0.08};

  bool powered = true;          // brakes released and running as soon as it has booted
  double boot_delay_s = 0;      // BOOTING for that long
  double power_delay_s = 0.5;   // of each step from POWER_OFF to RUNNING
  double time_offset_s = 600;   // of the clock at the start; below 40 a controller is still booting
  double time_factor = 1;       // controller seconds a second
  double speed_slider = 1;      // 0..1
  Vector6 tcp_force = Vector6::Zero();  // at rest in air [N, Nm]

  // An operator who answers each popup after that time; none: AnswerPopup does.
  std::optional<double> popup_answer_s = 0.2;
  bool safeguard_resumes = true;  // the program goes on when the safeguard input clears
  // The manual's rules for uploads. Controllers take more, and ur_rtde's program needs it: lines in
  // column 0, statements that go on over line ends.
  bool strict_scripts = true;
  std::map<std::string, std::string> stored_programs;  // for the dashboard's `load`: name to script
};

}  // namespace sandwright
