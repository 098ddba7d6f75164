// The primary interface's packets as values: what the controller says about programs and itself.
//
// A packet is its size (i32, with the header), a type (u8) and a payload, big-endian. A
// ROBOT_MESSAGE is one event; a ROBOT_STATE, ten times a second, is a row of sub-packages that are
// built alike.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "robot_model/controller/arm_state.h"
#include "robot_model/controller/packet_framer.h"

namespace sandwright {

// A whole ROBOT_STATE has some 1.5 kB.
inline constexpr PacketFormat kPrimaryFormat{4, 65536, {}};

struct VersionMessage {
  std::string project;
  uint8_t major = 0, minor = 0;
  int32_t bugfix = 0, build = 0;
};
struct SafetyModeMessage {
  int32_t code = 0, argument = 0;
  SafetyMode mode = SafetyMode::kFault;
};
struct ErrorCodeMessage {
  int32_t code = 0, argument = 0, level = 0;
  std::string text;
  // The controller then ends the program: violations, faults and their development variants.
  bool is_serious() const { return (level & 0x7f) >= 3; }
};
struct KeyMessage {
  int32_t code = 0, argument = 0;
  std::string title, text;  // e.g. PROGRAM_XXX_STARTED and the program's name
};
struct TextMessage {
  std::string text;  // of textmsg()
};
struct RuntimeExceptionMessage {
  int32_t line = 0, column = 0;
  std::string text;
};
struct PopupMessage {
  bool is_warning = false, is_error = false, is_blocking = false;
  std::string title, text;
};

struct RobotModeData {
  bool is_powered = false, is_emergency_stopped = false, is_protective_stopped = false;
  bool is_program_running = false, is_program_paused = false;
  RobotMode mode = RobotMode::kDisconnected;
};
// The factory calibration. Sent in the first state after connecting.
struct KinematicsInfo {
  std::array<uint32_t, 6> checksums = {};
  DhParameters dh;
  uint32_t status = 0;
};

using PrimaryItem =
    std::variant<VersionMessage, SafetyModeMessage, ErrorCodeMessage, KeyMessage, TextMessage,
                 RuntimeExceptionMessage, PopupMessage, RobotModeData, KinematicsInfo>;

// What a packet holds of the above, in its order; kinds that are not among them are passed over, as
// are fields that newer versions append. None where a known kind is cut short, a sub-package's size
// is not inside the packet, or a calibration is not finite.
std::optional<std::vector<PrimaryItem>> ParsePrimaryPacket(const Packet& packet);

}  // namespace sandwright
