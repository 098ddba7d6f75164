// The real-time data exchange (RTDE), protocol version 2, as values: requests, replies, frames.
//
// A packet is its size (u16, with the header), a type (u8) and a payload, big-endian. The client
// asks for the protocol, the version, a recipe of outputs and one of inputs, and starts the stream.
#pragma once

#include <optional>
#include <string>

#include "robot_model/controller/arm_state.h"
#include "robot_model/controller/packet_framer.h"

namespace sandwright {

enum class RtdeType : uint8_t {
  kProtocol = 'V',
  kVersion = 'v',
  kText = 'M',
  kData = 'U',
  kOutputs = 'O',
  kInputs = 'I',
  kStart = 'S',
  kPause = 'P',
};
inline constexpr PacketFormat kRtdeFormat{2, 0xffff, "VvMUOISP"};
inline constexpr double kRtdePeriod_s = 0.008;  // of a CB3: 125 Hz

// What we read, in the order of ArmState, and what we write. The speed slider is not among the
// inputs: no software of ours can raise it.
extern const char* const kRtdeOutputs;      // names, joined by commas
extern const char* const kRtdeOutputTypes;  // as the controller answers
extern const char* const kRtdeInputs;
extern const char* const kRtdeInputTypes;

Bytes RtdeProtocolRequest();
Bytes RtdeVersionRequest();
Bytes RtdeOutputsRequest();  // kRtdeOutputs at 125 Hz
Bytes RtdeInputsRequest();   // kRtdeInputs
Bytes RtdeStartRequest();
Bytes RtdePauseRequest();
// A data packet for the input recipe; ProgramRegisters::kBeat and kCommand.
Bytes RtdeInputs(uint8_t recipe, int32_t beat, int32_t command);

struct ControllerVersion {
  uint32_t major = 0, minor = 0, bugfix = 0, build = 0;
  auto operator<=>(const ControllerVersion&) const = default;
};
std::string Name(const ControllerVersion& version);  // "3.15.8.106339"

struct RtdeRecipe {
  uint8_t id = 0;     // 0: refused
  std::string types;  // joined by commas; NOT_FOUND or IN_USE in the place of a type
};

struct RtdeText {
  std::string message, source;
  uint8_t level = 3;  // 0 exception, 1 error, 2 warning, 3 information
};

// Each takes a payload and gives none where it is shorter or longer than it must be.
std::optional<bool> ParseRtdeAccepted(std::span<const uint8_t> payload);  // of V, S and P
std::optional<ControllerVersion> ParseRtdeVersion(std::span<const uint8_t> payload);
std::optional<RtdeRecipe> ParseRtdeRecipe(std::span<const uint8_t> payload);  // of O and I
std::optional<RtdeText> ParseRtdeText(std::span<const uint8_t> payload);
// None as well where the recipe is another one or a number is not finite: a guard that compares
// with NaN is no guard.
std::optional<ArmState> ParseArmState(std::span<const uint8_t> payload, uint8_t recipe);

}  // namespace sandwright
