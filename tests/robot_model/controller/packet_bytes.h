// Bytes as a controller sends them, packed independently of the parsers under test.
#pragma once

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "robot_model/controller/packet_framer.h"
#include "robot_model/controller/rtde.h"

namespace sandwright {

inline Bytes FromHex(const std::string& hex) {
  std::istringstream words(hex);
  Bytes bytes;
  for (std::string word; words >> word;)
    bytes.push_back(static_cast<uint8_t>(std::stoi(word, nullptr, 16)));
  return bytes;
}

inline Bytes operator+(Bytes bytes, const Bytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
  return bytes;
}
inline Bytes operator+(Bytes bytes, const std::string& text) {
  bytes.insert(bytes.end(), text.begin(), text.end());
  return bytes;
}

inline Bytes StateFrame(const ArmState& state, uint8_t recipe) {
  BigEndianWriter frame;
  frame.U16(348);
  frame.U8('U');
  frame.U8(recipe);
  frame.F64(state.timestamp_s);
  for (const Vector6* vector : {&state.target_q.rad, &state.actual_q.rad, &state.actual_qd_radps,
                                &state.tcp_pose, &state.tcp_speed, &state.tcp_force})
    for (const double value : *vector) frame.F64(value);
  frame.F64(state.speed_scaling);
  frame.F64(state.target_speed_fraction);
  frame.U32(static_cast<uint32_t>(state.runtime_state));
  frame.I32(static_cast<int32_t>(state.robot_mode));
  frame.I32(static_cast<int32_t>(state.safety_mode));
  frame.U32(state.robot_status_bits);
  frame.U32(state.safety_status_bits);
  for (const int32_t value : state.output_registers) frame.I32(value);
  return frame.bytes();
}

// A ROBOT_MESSAGE of the primary interface around `body`.
inline Bytes PrimaryMessage(uint8_t message_type, const Bytes& body) {
  BigEndianWriter packet;
  packet.U32(static_cast<uint32_t>(15 + body.size()));
  packet.U8(20);
  packet.U64(123456789);
  packet.U8(254);
  packet.U8(message_type);
  return packet.bytes() + body;
}

inline Bytes KeyBody(const std::string& title, const std::string& text) {
  BigEndianWriter body;
  body.I32(0);
  body.I32(0);
  body.U8(static_cast<uint8_t>(title.size()));
  body.Text(title + text);
  return body.bytes();
}

// A ROBOT_STATE with a RUNNING arm, a sub-package that nobody knows, and this calibration.
inline Bytes PrimaryState(const DhParameters& dh) {
  BigEndianWriter mode;
  mode.U32(47);
  mode.U8(0);
  mode.U64(42);
  for (const bool flag : {true, true, true, false, false, true, false}) mode.U8(flag);
  mode.U8(7);
  mode.U8(0);
  for (int i = 0; i < 3; ++i) mode.F64(1);
  mode.U8(0);
  BigEndianWriter unknown;
  unknown.U32(9);
  unknown.U8(77);
  unknown.U32(0xdeadbeef);
  BigEndianWriter kinematics;
  kinematics.U32(225);
  kinematics.U8(5);
  for (uint32_t i = 0; i < 6; ++i) kinematics.U32(100 + i);
  for (const auto* row : {&dh.theta_rad, &dh.a_m, &dh.d_m, &dh.alpha_rad})
    for (const double value : *row) kinematics.F64(value);
  kinematics.U32(2);
  const Bytes parts = mode.bytes() + unknown.bytes() + kinematics.bytes();
  BigEndianWriter packet;
  packet.U32(static_cast<uint32_t>(5 + parts.size()));
  packet.U8(16);
  return packet.bytes() + parts;
}

struct OwnedPacket {
  uint8_t type;
  Bytes payload;
};

// All packets of a stream that arrives in pieces of that many bytes.
inline std::vector<OwnedPacket> Cut(const PacketFormat& format, const Bytes& stream, size_t piece) {
  PacketFramer framer(format);
  std::vector<OwnedPacket> packets;
  for (size_t at = 0; at < stream.size(); at += piece) {
    framer.Feed(std::span(stream).subspan(at, std::min(piece, stream.size() - at)));
    while (const auto packet = framer.Next())
      packets.push_back({packet->type, Bytes(packet->payload.begin(), packet->payload.end())});
  }
  return packets;
}

}  // namespace sandwright
