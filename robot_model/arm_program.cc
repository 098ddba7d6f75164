#include "robot_model/arm_program.h"

#include <spdlog/fmt/fmt.h>

#include "data/base/error.h"
#include "robot_model/urscript_writer.h"

namespace sandwright {
namespace {

constexpr double kTcpTolerance_m = 1e-4, kTcpTolerance_rad = 1e-3, kPayloadTolerance_kg = 0.01;
constexpr int kMissedBeats = 12;  // periods of 8 ms

std::string SetPhase(ProgramPhase phase) {
  return fmt::format("write_output_integer_register({}, {})", ProgramRegisters::kPhase,
                     static_cast<int>(phase));
}

// Ends the program, which stops the arm, when the PC is gone or asks for it.
void WriteGuard(UrScriptWriter& writer) {
  const std::string beat =
      fmt::format("read_input_integer_register({})", ProgramRegisters::kBeat);
  writer.Line("thread guard():");
  writer.Line("  beat = " + beat);
  writer.Line("  missed = 0");
  writer.Line("  pulse = 0");
  writer.Line("  while (True):");
  writer.Line("    now = " + beat);
  writer.Line("    if (now == beat):");
  writer.Line("      missed = missed + 1");
  writer.Line("    else:");
  writer.Line("      missed = 0");
  writer.Line("    end");
  writer.Line("    beat = now");
  writer.Line("    pulse = pulse + 1");
  writer.Line(
      fmt::format("    write_output_integer_register({}, pulse)", ProgramRegisters::kPulse));
  const auto leave = [&](const std::string& condition, ProgramPhase phase, const char* message) {
    writer.Line("    if (" + condition + "):");
    writer.Line("      " + SetPhase(phase));
    writer.Line(fmt::format("      textmsg(\"Sandwright: {}\")", message));
    writer.Line("      halt");
    writer.Line("    end");
  };
  leave(fmt::format("read_input_integer_register({}) != 0", ProgramRegisters::kCommand),
        ProgramPhase::kAskedToStop, "stopped as asked");
  leave(fmt::format("missed > {}", kMissedBeats), ProgramPhase::kBeatLost,
        "the PC is silent; stopped");
  writer.Line("    sync()");
  writer.Line("  end");
  writer.Line("end");
}

// The installation's tool must be the workcell's: nothing here sets it.
void RequireTool(const ToolSettings& tool, UrScriptWriter& writer) {
  writer.Line("tcp = get_tcp_offset()");
  std::string differs;
  for (size_t i = 0; i < 6; ++i) {
    const double wanted = i < 3 ? tool.X_FT.translation_m[i] : tool.X_FT.rotation_vector_rad[i - 3];
    writer.Line(fmt::format("tcp_{} = norm(tcp[{}] - ({:.6f}))", i + 1, i, wanted));
    differs += fmt::format("{}tcp_{} > {}", i > 0 ? " or " : "", i + 1,
                           i < 3 ? kTcpTolerance_m : kTcpTolerance_rad);
  }
  const auto leave = [&](const std::string& condition, ProgramPhase phase, const char* message) {
    writer.Line("if (" + condition + "):");
    writer.Line("  " + SetPhase(phase));
    writer.Line(fmt::format("  textmsg(\"Sandwright: {}; nothing was moved\")", message));
    writer.Line("  halt");
    writer.Line("end");
  };
  leave(differs, ProgramPhase::kOtherTcp, "the installation has another TCP");
  writer.Line(fmt::format("payload = norm(get_target_payload() - {:.4f})", tool.mass_kg));
  leave(fmt::format("payload > {}", kPayloadTolerance_kg), ProgramPhase::kOtherPayload,
        "the installation has another payload");
}

}  // namespace

ArmProgram MakeArmProgram(const GatedMotion& motion, const SafetyGate& gate,
                          const std::string& name, double speed_share) {
  CheckProgramName(name);
  UrScriptWriter writer(gate, speed_share, ProgramRegisters::kSegment);
  writer.Cell();
  WriteGuard(writer);
  writer.Line(SetPhase(ProgramPhase::kRunning));
  RequireTool(gate.workcell().tool, writer);
  writer.RequireJoints(motion.start(), "the arm is not where the motion begins; nothing was moved",
                       SetPhase(ProgramPhase::kNotAtStart));
  writer.Line("run guard()");
  switch (motion.kind()) {
    case GatedMotion::Kind::kStroke:
      writer.StrokeMoves(motion.stroke(), motion.stroke_motion());
      break;
    case GatedMotion::Kind::kTransfer: writer.Joints(motion.end()); break;
    case GatedMotion::Kind::kLift: writer.BladeTo(motion.end(), kLiftSpeed_mps); break;
  }
  writer.Line(SetPhase(ProgramPhase::kFinished));
  ArmProgram program(motion);
  program.name_ = name;
  program.speed_share_ = speed_share;
  program.text_ = "def " + name + "():\n" + writer.Take() + "end\n";
  return program;
}

}  // namespace sandwright
