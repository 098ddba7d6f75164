#include "robot_model/controller/primary.h"

#include <algorithm>
#include <cmath>

namespace sandwright {
namespace {

constexpr uint8_t kRobotState = 16, kRobotMessage = 20;
constexpr uint8_t kModeData = 0, kKinematics = 5;  // sub-packages

enum MessageType : uint8_t {
  kText = 0,
  kPopup = 2,
  kVersion = 3,
  kSafetyMode = 5,
  kErrorCode = 6,
  kKey = 7,
  kRuntimeException = 10,
};

using Items = std::vector<PrimaryItem>;

VersionMessage ReadVersion(BigEndianReader& reader) {
  VersionMessage version;
  version.project = reader.Text(reader.U8());
  version.major = reader.U8();
  version.minor = reader.U8();
  version.bugfix = reader.I32();
  version.build = reader.I32();
  return version;
}

SafetyModeMessage ReadSafetyMode(BigEndianReader& reader) {
  SafetyModeMessage message;
  message.code = reader.I32();
  message.argument = reader.I32();
  message.mode = static_cast<SafetyMode>(reader.U8());
  return message;
}

ErrorCodeMessage ReadErrorCode(BigEndianReader& reader) {
  ErrorCodeMessage message;
  message.code = reader.I32();
  message.argument = reader.I32();
  message.level = reader.I32();
  reader.Take(8);  // type and value of data that only the maker can read
  message.text = reader.TextRest();
  return message;
}

KeyMessage ReadKey(BigEndianReader& reader) {
  KeyMessage message;
  message.code = reader.I32();
  message.argument = reader.I32();
  message.title = reader.Text(reader.U8());
  message.text = reader.TextRest();
  return message;
}

RuntimeExceptionMessage ReadRuntimeException(BigEndianReader& reader) {
  RuntimeExceptionMessage message;
  message.line = reader.I32();
  message.column = reader.I32();
  message.text = reader.TextRest();
  return message;
}

PopupMessage ReadPopup(BigEndianReader& reader) {
  PopupMessage message;
  reader.Take(5);  // number and kind of the request
  message.is_warning = reader.U8() != 0;
  message.is_error = reader.U8() != 0;
  message.is_blocking = reader.U8() != 0;
  message.title = reader.Text(reader.U8());
  message.text = reader.TextRest();
  return message;
}

std::optional<Items> ParseMessage(BigEndianReader& reader) {
  reader.Take(9);  // time stamp and source
  const uint8_t type = reader.U8();
  Items items;
  switch (type) {
    case kText: items.push_back(TextMessage{reader.TextRest()}); break;
    case kPopup: items.push_back(ReadPopup(reader)); break;
    case kVersion: items.push_back(ReadVersion(reader)); break;
    case kSafetyMode: items.push_back(ReadSafetyMode(reader)); break;
    case kErrorCode: items.push_back(ReadErrorCode(reader)); break;
    case kKey: items.push_back(ReadKey(reader)); break;
    case kRuntimeException: items.push_back(ReadRuntimeException(reader)); break;
  }
  if (!reader.ok()) return std::nullopt;
  return items;
}

RobotModeData ReadModeData(BigEndianReader& reader) {
  RobotModeData data;
  reader.Take(10);  // time stamp, and whether there is a real arm and it may move
  data.is_powered = reader.U8() != 0;
  data.is_emergency_stopped = reader.U8() != 0;
  data.is_protective_stopped = reader.U8() != 0;
  data.is_program_running = reader.U8() != 0;
  data.is_program_paused = reader.U8() != 0;
  data.mode = static_cast<RobotMode>(reader.I8());
  return data;
}

KinematicsInfo ReadKinematics(BigEndianReader& reader) {
  KinematicsInfo info;
  for (uint32_t& checksum : info.checksums) checksum = reader.U32();
  for (std::vector<double>* row :
       {&info.dh.theta_rad, &info.dh.a_m, &info.dh.d_m, &info.dh.alpha_rad})
    for (double& value : *row) value = reader.F64() + 0.0;  // -0 is 0 for a hash
  info.status = reader.U32();
  return info;
}

bool IsFinite(const DhParameters& dh) {
  for (const std::vector<double>* row : {&dh.theta_rad, &dh.a_m, &dh.d_m, &dh.alpha_rad})
    if (!std::all_of(row->begin(), row->end(), [](double value) { return std::isfinite(value); }))
      return false;
  return true;
}

std::optional<Items> ParseState(BigEndianReader& reader) {
  Items items;
  while (reader.remaining() > 0) {
    const uint32_t size = reader.U32();
    const uint8_t type = reader.U8();
    if (!reader.ok() || size < 5 || size - 5 > reader.remaining()) return std::nullopt;
    BigEndianReader part(reader.Take(size - 5));
    if (type == kModeData) items.push_back(ReadModeData(part));
    if (type == kKinematics) {
      const KinematicsInfo info = ReadKinematics(part);
      if (!IsFinite(info.dh)) return std::nullopt;
      items.push_back(info);
    }
    if (!part.ok()) return std::nullopt;
  }
  return items;
}

}  // namespace

std::optional<Items> ParsePrimaryPacket(const Packet& packet) {
  BigEndianReader reader(packet.payload);
  if (packet.type == kRobotMessage) return ParseMessage(reader);
  if (packet.type == kRobotState) return ParseState(reader);
  return Items{};
}

}  // namespace sandwright
