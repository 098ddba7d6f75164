#include "tests/support/controller_fake/primary_packets.h"

#include <numbers>

#include "tests/support/controller_fake/byte_packing.h"

namespace sandwright::fake {
namespace {

constexpr uint8_t kRobotState = 16, kRobotMessage = 20;
constexpr uint8_t kFromPolyScope = 255;  // source: not a joint or tool
constexpr float kVoltage_V = 48, kTemperature_degC = 30;
constexpr uint8_t kJointRunning = 253, kJointPowerOff = 239;
constexpr int kRobotTypeUr10 = 2;

uint64_t Microseconds(double time_s) { return static_cast<uint64_t>(time_s * 1e6); }

std::string Packet(uint8_t type, const ByteWriter& body) {
  return ByteWriter()
      .U32(static_cast<uint32_t>(5 + body.bytes().size()))
      .U8(type)
      .Text(body.bytes())
      .bytes();
}

ByteWriter Message(double time_s, uint8_t message_type) {
  ByteWriter body;
  body.U64(Microseconds(time_s)).U8(kFromPolyScope).U8(message_type);
  return body;
}

std::string ModePart(const ControllerState& s) {
  ByteWriter body;
  body.U64(Microseconds(s.time_s))
      .U8(1)
      .U8(1)
      .U8(s.Powered())
      .U8(s.EmergencyStopped())
      .U8(s.safety_mode == SafetyMode::kProtectiveStop)
      .U8(s.ProgramAlive())
      .U8(s.runtime == RuntimeState::kPaused)
      .U8(static_cast<uint8_t>(s.robot_mode))
      .U8(0)  // position control
      .F64(s.speed_slider)
      .F64(s.speed_scaling)
      .F64(1);
  return Packet(0, body);
}

std::string JointPart(const ControllerState& s) {
  ByteWriter body;
  for (int i = 0; i < 6; ++i) {
    body.F64(s.q[i]).F64(s.q[i]).F64(s.qd_radps[i]);
    body.F32(0).F32(kVoltage_V).F32(kTemperature_degC).F32(kTemperature_degC);
    body.U8(s.Powered() ? kJointRunning : kJointPowerOff);
  }
  return Packet(1, body);
}

std::string CartesianPart(const ControllerState& s) {
  ByteWriter body;
  body.F64s(PoseVector(s.X_WT)).F64s(PoseVector(s.X_FT));
  return Packet(4, body);
}

std::string KinematicsPart(const DhParameters& dh) {
  ByteWriter body;
  // The true sums are not published; here they only have to change with the parameters.
  for (int i = 0; i < 6; ++i) {
    uint32_t sum = 2166136261u;
    ByteWriter row;
    row.F64(dh.theta_rad[i]).F64(dh.a_m[i]).F64(dh.d_m[i]).F64(dh.alpha_rad[i]);
    for (const char byte : row.bytes()) sum = (sum ^ static_cast<uint8_t>(byte)) * 16777619u;
    body.U32(sum);
  }
  body.F64s(dh.theta_rad).F64s(dh.a_m).F64s(dh.d_m).F64s(dh.alpha_rad);
  body.U32(1);  // calibrated
  return Packet(5, body);
}

std::string ConfigurationPart(const DhParameters& dh) {
  constexpr double kTurn = 2 * std::numbers::pi;
  ByteWriter body;
  for (int i = 0; i < 6; ++i) body.F64(-kTurn).F64(kTurn);
  for (int i = 0; i < 6; ++i) body.F64(i < 2 ? kTurn / 3 : kTurn / 2).F64(40);
  body.F64(1.05).F64(1.4).F64(0.25).F64(1.2).F64(0.2);  // default speeds and accelerations, radius
  body.F64s(dh.a_m).F64s(dh.d_m).F64s(dh.alpha_rad).F64s(dh.theta_rad);
  body.I32(0).I32(0).I32(kRobotTypeUr10).I32(1);
  return Packet(6, body);
}

}  // namespace

std::string VersionPacket(double time_s, std::array<uint32_t, 4> version) {
  ByteWriter body = Message(time_s, 3);
  body.ShortText("URControl")
      .U8(static_cast<uint8_t>(version[0]))
      .U8(static_cast<uint8_t>(version[1]))
      .U32(version[2])
      .U32(version[3])
      .Text("01-01-2020, 00:00:00");
  return Packet(kRobotMessage, body);
}

std::string KeyPacket(double time_s, std::string_view title, std::string_view text) {
  return Packet(kRobotMessage, Message(time_s, 7).I32(0).I32(0).ShortText(title).Text(text));
}

std::string TextPacket(double time_s, std::string_view text) {
  return Packet(kRobotMessage, Message(time_s, 0).Text(text));
}

std::string PopupPacket(double time_s, std::string_view title, std::string_view text, bool warning,
                        bool error) {
  ByteWriter body = Message(time_s, 2);
  body.U32(1).U8(0).U8(warning).U8(error).U8(0).U32(0).ShortText(title).Text(text);
  return Packet(kRobotMessage, body);
}

std::string ErrorCodePacket(double time_s, int code, int argument, ReportLevel level,
                            std::string_view text) {
  ByteWriter body = Message(time_s, 6);
  body.I32(code).I32(argument).I32(static_cast<int>(level)).U32(0).U32(0).Text(text);
  return Packet(kRobotMessage, body);
}

std::string SafetyModePacket(double time_s, SafetyMode mode) {
  ByteWriter body = Message(time_s, 5);
  body.I32(0).I32(0).U8(static_cast<uint8_t>(mode)).U32(0).U32(0);
  return Packet(kRobotMessage, body);
}

std::string RuntimeExceptionPacket(double time_s, int line, int column, std::string_view text) {
  return Packet(kRobotMessage, Message(time_s, 10).I32(line).I32(column).Text(text));
}

std::string RobotStatePacket(const ControllerState& state, const DhParameters& dh) {
  ByteWriter body;
  body.Text(ModePart(state)).Text(JointPart(state)).Text(CartesianPart(state));
  body.Text(KinematicsPart(dh)).Text(ConfigurationPart(dh));
  return Packet(kRobotState, body);
}

std::string RealtimePacket(const ControllerState& s) {
  constexpr uint32_t kSize = 1108;
  const auto zeros = [](int count) { return std::string(8 * count, '\0'); };
  ByteWriter w;
  w.U32(kSize).F64(s.time_s);
  w.F64s(s.q.rad).F64s(s.qd_radps).F64s(s.qdd_radps2).Text(zeros(12));  // target; current, moment
  w.F64s(s.q.rad).F64s(s.qd_radps).Text(zeros(12));                     // actual; current, control
  w.F64s(PoseVector(s.X_WT)).F64s(s.tcp_speed).F64s(s.tcp_force);
  w.F64s(PoseVector(s.X_WT)).F64s(s.tcp_speed);
  w.F64(static_cast<double>(s.digital_inputs));
  w.F64s(std::array{30.0, 30.0, 30.0, 30.0, 30.0, 30.0});  // temperatures
  w.Text(zeros(2)).F64(static_cast<double>(s.robot_mode));
  for (int i = 0; i < 6; ++i) w.F64(s.Powered() ? kJointRunning : kJointPowerOff);
  w.F64(static_cast<double>(s.safety_mode)).Text(zeros(6 + 3 + 6));
  w.F64(s.speed_scaling).Text(zeros(3)).F64(kVoltage_V).F64(kVoltage_V).F64(0);
  for (int i = 0; i < 6; ++i) w.F64(kVoltage_V);
  w.F64(static_cast<double>(s.digital_outputs)).F64(static_cast<double>(s.runtime));
  w.Text(zeros(6));  // elbow
  return w.bytes();
}

}  // namespace sandwright::fake
