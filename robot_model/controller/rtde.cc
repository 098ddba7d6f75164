#include "robot_model/controller/rtde.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

namespace sandwright {

const char* const kRtdeOutputs =
    "timestamp,target_q,actual_q,actual_qd,actual_TCP_pose,actual_TCP_speed,actual_TCP_force,"
    "speed_scaling,target_speed_fraction,runtime_state,robot_mode,safety_mode,robot_status_bits,"
    "safety_status_bits,output_int_register_0,output_int_register_1,output_int_register_2";
const char* const kRtdeOutputTypes =
    "DOUBLE,VECTOR6D,VECTOR6D,VECTOR6D,VECTOR6D,VECTOR6D,VECTOR6D,"
    "DOUBLE,DOUBLE,UINT32,INT32,INT32,UINT32,UINT32,INT32,INT32,INT32";
const char* const kRtdeInputs = "input_int_register_0,input_int_register_1";
const char* const kRtdeInputTypes = "INT32,INT32";

namespace {

Bytes Framed(RtdeType type, const BigEndianWriter& payload = {}) {
  BigEndianWriter packet;
  packet.U16(static_cast<uint16_t>(payload.bytes().size() + 3));
  packet.U8(static_cast<uint8_t>(type));
  Bytes bytes = packet.bytes();
  bytes.insert(bytes.end(), payload.bytes().begin(), payload.bytes().end());
  return bytes;
}

Vector6 ReadVector6(BigEndianReader& reader) {
  Vector6 vector;
  for (int i = 0; i < 6; ++i) vector[i] = reader.F64();
  return vector;
}

}  // namespace

Bytes RtdeProtocolRequest() {
  BigEndianWriter payload;
  payload.U16(2);
  return Framed(RtdeType::kProtocol, payload);
}

Bytes RtdeVersionRequest() { return Framed(RtdeType::kVersion); }

Bytes RtdeOutputsRequest() {
  BigEndianWriter payload;
  payload.F64(1 / kRtdePeriod_s);
  payload.Text(kRtdeOutputs);
  return Framed(RtdeType::kOutputs, payload);
}

Bytes RtdeInputsRequest() {
  BigEndianWriter payload;
  payload.Text(kRtdeInputs);
  return Framed(RtdeType::kInputs, payload);
}

Bytes RtdeStartRequest() { return Framed(RtdeType::kStart); }
Bytes RtdePauseRequest() { return Framed(RtdeType::kPause); }

Bytes RtdeInputs(uint8_t recipe, int32_t beat, int32_t command) {
  BigEndianWriter payload;
  payload.U8(recipe);
  payload.I32(beat);
  payload.I32(command);
  return Framed(RtdeType::kData, payload);
}

std::string Name(const ControllerVersion& version) {
  return fmt::format("{}.{}.{}.{}", version.major, version.minor, version.bugfix, version.build);
}

std::optional<bool> ParseRtdeAccepted(std::span<const uint8_t> payload) {
  BigEndianReader reader(payload);
  const uint8_t accepted = reader.U8();
  if (!reader.complete() || accepted > 1) return std::nullopt;
  return accepted == 1;
}

std::optional<ControllerVersion> ParseRtdeVersion(std::span<const uint8_t> payload) {
  BigEndianReader reader(payload);
  ControllerVersion version;
  version.major = reader.U32();
  version.minor = reader.U32();
  version.bugfix = reader.U32();
  version.build = reader.U32();
  if (!reader.complete()) return std::nullopt;
  return version;
}

std::optional<RtdeRecipe> ParseRtdeRecipe(std::span<const uint8_t> payload) {
  BigEndianReader reader(payload);
  RtdeRecipe recipe;
  recipe.id = reader.U8();
  recipe.types = reader.TextRest();
  if (!reader.complete() || recipe.types.empty()) return std::nullopt;
  return recipe;
}

std::optional<RtdeText> ParseRtdeText(std::span<const uint8_t> payload) {
  BigEndianReader reader(payload);
  RtdeText text;
  text.message = reader.Text(reader.U8());
  text.source = reader.Text(reader.U8());
  text.level = reader.U8();
  if (!reader.complete()) return std::nullopt;
  return text;
}

std::optional<ArmState> ParseArmState(std::span<const uint8_t> payload, uint8_t recipe) {
  BigEndianReader reader(payload);
  if (reader.U8() != recipe) return std::nullopt;
  ArmState state;
  state.timestamp_s = reader.F64();
  for (Vector6* vector : {&state.target_q.rad, &state.actual_q.rad, &state.actual_qd_radps,
                          &state.tcp_pose, &state.tcp_speed, &state.tcp_force}) {
    *vector = ReadVector6(reader);
    if (!vector->allFinite()) return std::nullopt;
  }
  state.speed_scaling = reader.F64();
  state.target_speed_fraction = reader.F64();
  state.runtime_state = static_cast<RuntimeState>(reader.U32());
  state.robot_mode = static_cast<RobotMode>(reader.I32());
  state.safety_mode = static_cast<SafetyMode>(reader.I32());
  state.robot_status_bits = reader.U32();
  state.safety_status_bits = reader.U32();
  for (int32_t& output : state.output_registers) output = reader.I32();
  const bool finite = std::isfinite(state.timestamp_s) && std::isfinite(state.speed_scaling) &&
                      std::isfinite(state.target_speed_fraction);
  if (!reader.complete() || !finite) return std::nullopt;
  return state;
}

}  // namespace sandwright
