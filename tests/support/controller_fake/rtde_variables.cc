#include "tests/support/controller_fake/rtde_variables.h"

#include <array>

namespace sandwright::fake {
namespace {

using State = ControllerState;
using Outputs = std::map<std::string, RtdeOutput>;
using Inputs = std::map<std::string, RtdeInput>;

constexpr double kMainVoltage_V = 48, kJointTemperature_degC = 30;

template <class Read>
void Double(Outputs& outputs, const std::string& name, Read read) {
  outputs[name] = {"DOUBLE", [read](const State& s, ByteWriter& w) { w.F64(read(s)); }};
}
template <class Read>
void Vector(Outputs& outputs, const std::string& name, Read read) {
  outputs[name] = {"VECTOR6D", [read](const State& s, ByteWriter& w) { w.F64s(read(s)); }};
}
template <class Read>
void Int(Outputs& outputs, const std::string& name, Read read) {
  outputs[name] = {"INT32", [read](const State& s, ByteWriter& w) {
                     w.I32(static_cast<int32_t>(read(s)));
                   }};
}
template <class Read>
void Bits(Outputs& outputs, const std::string& name, Read read) {
  outputs[name] = {"UINT32", [read](const State& s, ByteWriter& w) { w.U32(read(s)); }};
}

uint32_t RobotStatusBits(const State& s) {
  return (s.Powered() ? 1u : 0u) | (s.ProgramAlive() ? 2u : 0u);
}

uint32_t SafetyStatusBits(const State& s) {
  switch (s.safety_mode) {
    case SafetyMode::kNormal: return 1u;
    case SafetyMode::kReduced: return 1u << 1;
    case SafetyMode::kProtectiveStop: return 1u << 2 | 1u << 10;
    case SafetyMode::kRecovery: return 1u << 3;
    case SafetyMode::kSafeguardStop: return 1u << 4 | 1u << 10;
    case SafetyMode::kSystemEmergencyStop: return 1u << 5 | 1u << 7 | 1u << 10;
    case SafetyMode::kRobotEmergencyStop: return 1u << 6 | 1u << 7 | 1u << 10;
    case SafetyMode::kViolation: return 1u << 8 | 1u << 10;
    case SafetyMode::kFault: return 1u << 9 | 1u << 10;
  }
  return 0;
}

uint32_t Word(const std::array<bool, 64>& bits, int first) {
  uint32_t word = 0;
  for (int i = 0; i < 32; ++i) word |= static_cast<uint32_t>(bits[first + i]) << i;
  return word;
}

void AddMotion(Outputs& outputs) {
  const auto zero = [](const State&) { return Vector6(Vector6::Zero()); };
  for (const char* side : {"target", "actual"}) {
    const std::string name = side;
    Vector(outputs, name + "_q", [](const State& s) { return s.q.rad; });
    Vector(outputs, name + "_qd", [](const State& s) { return s.qd_radps; });
    Vector(outputs, name + "_current", zero);
    Vector(outputs, name + "_TCP_pose", [](const State& s) { return PoseVector(s.X_WT); });
    Vector(outputs, name + "_TCP_speed", [](const State& s) { return s.tcp_speed; });
  }
  Vector(outputs, "payload_inertia", zero);
  Vector(outputs, "target_qdd", [](const State& s) { return s.qdd_radps2; });
  Vector(outputs, "target_moment", zero);
  Vector(outputs, "joint_control_output", zero);
  Vector(outputs, "actual_TCP_force", [](const State& s) { return s.tcp_force; });
  Vector(outputs, "joint_temperatures",
         [](const State&) { return Vector6(Vector6::Constant(kJointTemperature_degC)); });
  Vector(outputs, "actual_joint_voltage",
         [](const State&) { return Vector6(Vector6::Constant(kMainVoltage_V)); });
  outputs["joint_mode"] = {"VECTOR6INT32", [](const State& s, ByteWriter& w) {
                             for (int i = 0; i < 6; ++i) w.I32(s.Powered() ? 253 : 239);
                           }};
  for (const char* name : {"actual_tool_accelerometer", "elbow_position", "elbow_velocity"})
    outputs[name] = {"VECTOR3D", [](const State&, ByteWriter& w) { w.F64(0).F64(0).F64(0); }};
}

void AddModes(Outputs& outputs) {
  Double(outputs, "timestamp", [](const State& s) { return s.time_s; });
  Double(outputs, "speed_scaling", [](const State& s) { return s.speed_scaling; });
  Double(outputs, "target_speed_fraction", [](const State& s) { return s.speed_slider; });
  for (const char* name : {"actual_execution_time", "actual_momentum", "actual_robot_current",
                           "tool_output_current", "standard_analog_input0",
                           "standard_analog_input1", "standard_analog_output0",
                           "standard_analog_output1", "io_current", "tool_analog_input0",
                           "tool_analog_input1"})
    Double(outputs, name, [](const State&) { return 0.0; });
  for (const char* name : {"actual_main_voltage", "actual_robot_voltage"})
    Double(outputs, name, [](const State&) { return kMainVoltage_V; });
  Int(outputs, "robot_mode", [](const State& s) { return s.robot_mode; });
  Int(outputs, "safety_mode", [](const State& s) { return s.safety_mode; });
  Bits(outputs, "runtime_state",
       [](const State& s) { return static_cast<uint32_t>(s.runtime); });
  Bits(outputs, "robot_status_bits", RobotStatusBits);
  Bits(outputs, "safety_status_bits", SafetyStatusBits);
  Bits(outputs, "analog_io_types", [](const State&) { return 0u; });
  outputs["actual_digital_input_bits"] = {
      "UINT64", [](const State& s, ByteWriter& w) { w.U64(s.digital_inputs); }};
  outputs["actual_digital_output_bits"] = {
      "UINT64", [](const State& s, ByteWriter& w) { w.U64(s.digital_outputs); }};
  Double(outputs, "payload", [](const State& s) { return s.payload_kg; });
  outputs["payload_cog"] = {"VECTOR3D",
                            [](const State& s, ByteWriter& w) { w.F64s(s.payload_cog_m); }};
  Vector(outputs, "tcp_offset", [](const State& s) { return PoseVector(s.X_FT); });
}

void AddRegisters(Outputs& outputs) {
  for (int i = 0; i < kRegisters; ++i) {
    const std::string number = std::to_string(i);
    Int(outputs, "output_int_register_" + number, [i](const State& s) { return s.output_int[i]; });
    Int(outputs, "input_int_register_" + number, [i](const State& s) { return s.inputs.ints[i]; });
    Double(outputs, "output_double_register_" + number,
           [i](const State& s) { return s.output_double[i]; });
    Double(outputs, "input_double_register_" + number,
           [i](const State& s) { return s.inputs.doubles[i]; });
  }
  for (const int first : {0, 32}) {
    const std::string range = std::to_string(first) + "_to_" + std::to_string(first + 31);
    Bits(outputs, "output_bit_registers" + range,
         [first](const State& s) { return Word(s.output_bit, first); });
    Bits(outputs, "input_bit_registers" + range,
         [first](const State& s) { return Word(s.inputs.bits, first); });
  }
}

void AddInputRegisters(Inputs& inputs) {
  for (int i = 0; i < kRegisters; ++i) {
    const std::string number = std::to_string(i);
    inputs["input_int_register_" + number] = {
        "INT32", [i](ByteReader& r, RtdePackage& p) { p.registers.ints[i] = r.I32(); }};
    inputs["input_double_register_" + number] = {
        "DOUBLE", [i](ByteReader& r, RtdePackage& p) { p.registers.doubles[i] = r.F64(); }};
  }
  for (const int first : {0, 32}) {
    inputs["input_bit_registers" + std::to_string(first) + "_to_" + std::to_string(first + 31)] = {
        "UINT32", [first](ByteReader& r, RtdePackage& p) {
          const uint32_t word = r.U32();
          for (int i = 0; i < 32; ++i) p.registers.bits[first + i] = word >> i & 1;
        }};
  }
}

}  // namespace

const std::map<std::string, RtdeOutput>& RtdeOutputs() {
  static const Outputs outputs = [] {
    Outputs all;
    AddMotion(all);
    AddModes(all);
    AddRegisters(all);
    return all;
  }();
  return outputs;
}

const std::map<std::string, RtdeInput>& RtdeInputs() {
  static const Inputs inputs = [] {
    Inputs all;
    AddInputRegisters(all);
    all["speed_slider_mask"] = {
        "UINT32", [](ByteReader& r, RtdePackage& p) { p.slider_mask = r.U32(); }};
    all["speed_slider_fraction"] = {
        "DOUBLE", [](ByteReader& r, RtdePackage& p) { p.slider_fraction = r.F64(); }};
    // Outputs of the cabinet, which nothing here listens to.
    for (const char* name : {"standard_digital_output_mask", "standard_digital_output",
                             "configurable_digital_output_mask", "configurable_digital_output",
                             "tool_digital_output_mask", "tool_digital_output",
                             "standard_analog_output_mask", "standard_analog_output_type"})
      all[name] = {"UINT8", [](ByteReader& r, RtdePackage&) { r.U8(); }};
    for (const char* name : {"standard_analog_output_0", "standard_analog_output_1"})
      all[name] = {"DOUBLE", [](ByteReader& r, RtdePackage&) { r.F64(); }};
    return all;
  }();
  return inputs;
}

}  // namespace sandwright::fake
