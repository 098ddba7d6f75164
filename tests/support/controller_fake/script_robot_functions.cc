// Registers, the installation, kinematics, waiting, messages.
#include <spdlog/fmt/fmt.h>

#include "tests/support/controller_fake/script_functions.h"

namespace sandwright::fake {
namespace {

using Evaluator = ScriptEvaluator;

template <class Array>
auto& Register(Array& registers, const Arguments& a) {
  const int32_t address = a.At(0, "address").Integer();
  if (address < 0 || address >= static_cast<int32_t>(registers.size()))
    throw ScriptError(fmt::format("register {} is out of 0..{}", address, registers.size() - 1));
  return registers[address];
}

void AddRegisters(BuiltIns& functions) {
  functions["read_input_integer_register"] = [](Evaluator& e, const Arguments& a) -> Value {
    return Register(e.machine().state.inputs.ints, a);
  };
  functions["read_input_float_register"] = [](Evaluator& e, const Arguments& a) -> Value {
    return Register(e.machine().state.inputs.doubles, a);
  };
  functions["read_input_boolean_register"] = [](Evaluator& e, const Arguments& a) -> Value {
    return Register(e.machine().state.inputs.bits, a);
  };
  functions["read_output_integer_register"] = [](Evaluator& e, const Arguments& a) -> Value {
    return Register(e.machine().state.output_int, a);
  };
  functions["read_output_float_register"] = [](Evaluator& e, const Arguments& a) -> Value {
    return Register(e.machine().state.output_double, a);
  };
  functions["read_output_boolean_register"] = [](Evaluator& e, const Arguments& a) -> Value {
    return Register(e.machine().state.output_bit, a);
  };
  functions["write_output_integer_register"] = [](Evaluator& e, const Arguments& a) -> Value {
    Register(e.machine().state.output_int, a) = a.At(1, "value").Integer();
    return {};
  };
  functions["write_output_float_register"] = [](Evaluator& e, const Arguments& a) -> Value {
    Register(e.machine().state.output_double, a) = a.At(1, "value").Number();
    return {};
  };
  functions["write_output_boolean_register"] = [](Evaluator& e, const Arguments& a) -> Value {
    Register(e.machine().state.output_bit, a) = a.At(1, "value").Truth();
    return {};
  };
  functions["rtde_set_watchdog"] = [](Evaluator& e, const Arguments& a) -> Value {
    RtdeWatchdog& watchdog = e.machine().watchdogs[a.At(0, "variable_name").String()];
    const double least_Hz = a.At(1, "min_frequency").Number();
    if (least_Hz <= 0) throw ScriptError("the watchdog's frequency must be over 0");
    watchdog.longest_pause_s = 1 / least_Hz;
    watchdog.begun_s = e.machine().state.time_s;
    if (const Value* action = a.Find(2, "action")) watchdog.action = action->String();
    return {};
  };
}

Eigen::Vector3d Three(const Value& value) {
  const std::vector<double> numbers = value.Numbers();
  if (numbers.size() != 3) throw ScriptError("3 numbers are needed");
  return {numbers[0], numbers[1], numbers[2]};
}

void AddInstallation(BuiltIns& functions) {
  functions["set_tcp"] = [](Evaluator& e, const Arguments& a) -> Value {
    e.machine().state.X_FT = a.At(0, "pose").ToIsometry();
    e.machine().arm.SetTcp(e.machine().state.X_FT);
    return {};
  };
  functions["get_tcp_offset"] = [](Evaluator& e, const Arguments&) {
    return Value::Pose(e.machine().state.X_FT);
  };
  functions["set_payload"] = [](Evaluator& e, const Arguments& a) -> Value {
    e.machine().state.payload_kg = a.At(0, "m").Number();
    if (const Value* cog = a.Find(1, "cog")) e.machine().state.payload_cog_m = Three(*cog);
    return {};
  };
  functions["set_payload_mass"] = [](Evaluator& e, const Arguments& a) -> Value {
    e.machine().state.payload_kg = a.At(0, "m").Number();
    return {};
  };
  functions["set_payload_cog"] = [](Evaluator& e, const Arguments& a) -> Value {
    e.machine().state.payload_cog_m = Three(a.At(0, "CoG"));
    return {};
  };
  for (const char* name : {"get_target_payload", "get_target_payload_mass"})
    functions[name] = [](Evaluator& e, const Arguments&) -> Value {
      return e.machine().state.payload_kg;
    };
  functions["get_target_payload_cog"] = [](Evaluator& e, const Arguments&) -> Value {
    const Eigen::Vector3d& cog = e.machine().state.payload_cog_m;
    return Value::List{cog.x(), cog.y(), cog.z()};
  };
}

Value InverseKin(Evaluator& e, const Arguments& a) {
  FakeArm& arm = e.machine().arm;
  const Value* near = a.Find(1, "qnear");
  const auto q =
      arm.Inverse(a.At(0, "x").ToIsometry(), near ? JointAngles{near->Six()} : arm.q());
  if (!q) throw ScriptError("get_inverse_kin: no solution");
  return Value::Joints(q->rad);
}

Value ForwardKin(Evaluator& e, const Arguments& a) {
  const FakeArm& arm = e.machine().arm;
  const Value* q = a.Find(0, "q");
  const Value* tcp = a.Find(1, "tcp");
  return Value::Pose(arm.kinematics().Forward(q ? JointAngles{q->Six()} : arm.q()) *
                     (tcp ? tcp->ToIsometry() : arm.tcp()));
}

void AddKinematics(BuiltIns& functions) {
  for (const char* name : {"get_actual_joint_positions", "get_target_joint_positions"})
    functions[name] = [](Evaluator& e, const Arguments&) {
      return Value::Joints(e.machine().arm.q().rad);
    };
  for (const char* name : {"get_actual_joint_speeds", "get_target_joint_speeds"})
    functions[name] = [](Evaluator& e, const Arguments&) {
      return Value::Joints(e.machine().arm.qd_radps());
    };
  for (const char* name : {"get_actual_tcp_pose", "get_target_tcp_pose"})
    functions[name] = [](Evaluator& e, const Arguments&) {
      return Value::Pose(e.machine().arm.TcpPose());
    };
  functions["get_actual_tool_flange_pose"] = [](Evaluator& e, const Arguments&) {
    return Value::Pose(e.machine().arm.kinematics().Forward(e.machine().arm.q()));
  };
  functions["get_tcp_force"] = [](Evaluator& e, const Arguments&) {
    return Value::Joints(e.machine().state.tcp_force);
  };
  functions["get_joint_torques"] = [](Evaluator&, const Arguments&) {
    return Value::Joints(Vector6::Zero());
  };
  functions["get_inverse_kin"] = InverseKin;
  functions["get_inverse_kin_has_solution"] = [](Evaluator& e, const Arguments& a) -> Value {
    FakeArm& arm = e.machine().arm;
    return arm.Inverse(a.At(0, "pose").ToIsometry(), arm.q()).has_value();
  };
  functions["get_forward_kin"] = ForwardKin;
  functions["is_steady"] = [](Evaluator& e, const Arguments&) -> Value {
    return e.machine().arm.AtRest();
  };
  functions["is_within_safety_limits"] = [](Evaluator& e, const Arguments& a) -> Value {
    const Value& target = a.At(0, "pose");
    FakeArm& arm = e.machine().arm;
    return !target.As<PoseValue>() || arm.Inverse(target.ToIsometry(), arm.q()).has_value();
  };
}

Value ShowPopup(Evaluator& e, const Arguments& a) {
  Popup popup;
  popup.text = a.At(0, "s").ToText();
  const auto truth = [&](size_t position, const char* name, bool otherwise) {
    const Value* value = a.Find(position, name);
    return value ? value->Truth() : otherwise;
  };
  const Value* title = a.Find(1, "title");
  popup.title = title ? title->String() : "Popup";
  popup.warning = truth(2, "warning", false);
  popup.error = truth(3, "error", false);
  popup.blocking = truth(4, "blocking", false);
  e.machine().popup = popup;
  e.machine().show(popup);
  if (popup.blocking) e.Yield([&] { return !e.machine().popup; });
  return {};
}

void AddWaiting(BuiltIns& functions) {
  functions["sync"] = [](Evaluator& e, const Arguments&) -> Value {
    e.Yield();
    return {};
  };
  functions["sleep"] = [](Evaluator& e, const Arguments& a) -> Value {
    const double end_s = e.machine().state.time_s + a.At(0, "t").Number();
    e.Yield([&] { return e.machine().state.time_s >= end_s - 1e-9; });
    return {};
  };
  functions["get_steptime"] = [](Evaluator&, const Arguments&) -> Value {
    return kControlPeriod_s;
  };
  functions["textmsg"] = [](Evaluator& e, const Arguments& a) -> Value {
    std::string text = a.At(0, "s1").ToText();
    if (const Value* more = a.Find(1, "s2")) text += more->ToText();
    e.machine().say(text);
    return {};
  };
  functions["popup"] = ShowPopup;
  functions["protective_stop"] = [](Evaluator& e, const Arguments&) -> Value {
    e.machine().protect("protective_stop() of the program");
    e.Yield();
    return {};
  };
  // Forces and freedrive are not modelled: these change nothing.
  for (const char* name : {"force_mode", "force_mode_set_damping", "end_force_mode", "set_gravity",
                           "end_freedrive_mode", "end_teach_mode", "set_tool_voltage"})
    functions[name] = [](Evaluator&, const Arguments&) { return Value(); };
}

}  // namespace

void AddRobotFunctions(BuiltIns& functions) {
  AddRegisters(functions);
  AddInstallation(functions);
  AddKinematics(functions);
  AddWaiting(functions);
}

}  // namespace sandwright::fake
