// Packets of the primary and secondary interface (ports 30001 and 30002) and the frame of the
// real-time interface (30003) of a CB3 3.15.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "tests/support/controller_fake/controller_state.h"

namespace sandwright::fake {

// Severity of an ERROR_CODE message.
enum class ReportLevel { kDebug = 0, kInfo = 1, kWarning = 2, kViolation = 3, kFault = 4 };

// Robot messages (type 20), each with the controller's clock in front.
std::string VersionPacket(double time_s, std::array<uint32_t, 4> version);
std::string KeyPacket(double time_s, std::string_view title, std::string_view text);
std::string TextPacket(double time_s, std::string_view text);
std::string PopupPacket(double time_s, std::string_view title, std::string_view text, bool warning,
                        bool error);
std::string ErrorCodePacket(double time_s, int code, int argument, ReportLevel level,
                            std::string_view text);
std::string SafetyModePacket(double time_s, SafetyMode mode);
// Line and column count from 1.
std::string RuntimeExceptionPacket(double time_s, int line, int column, std::string_view text);

// Robot state (type 16): mode, joints, Cartesian, kinematics and configuration.
std::string RobotStatePacket(const ControllerState& state, const DhParameters& dh);

// The 1108 bytes of the real-time interface.
std::string RealtimePacket(const ControllerState& state);

}  // namespace sandwright::fake
