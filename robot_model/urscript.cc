#include "robot_model/urscript.h"

#include <spdlog/fmt/fmt.h>

#include "data/base/error.h"
#include "robot_model/urscript_writer.h"

namespace sandwright {
namespace {

void WriteHead(const Workcell& cell, size_t strokes, UrScriptWriter& writer) {
  const ToolSettings& tool = cell.tool;
  const auto& c = tool.centre_of_mass_m;
  const auto& t = tool.X_FT.translation_m;
  const auto& r = tool.X_FT.rotation_vector_rad;
  writer.Cell();
  writer.Line(
      fmt::format("set_payload({:.3f}, [{:.4f}, {:.4f}, {:.4f}])", tool.mass_kg, c[0], c[1], c[2]));
  writer.Line(fmt::format("set_tcp(p[{:.5f}, {:.5f}, {:.5f}, {:.5f}, {:.5f}, {:.5f}])", t[0], t[1],
                          t[2], r[0], r[1], r[2]));
  writer.Comment("the arm must stand at home");
  writer.RequireJoints(cell.home(), "the arm is not at home; nothing was moved");
  writer.Line(
      fmt::format("popup(\"{} strokes in the sand box. Keep clear; continue to start.\", "
                  "title=\"Sandwright\", warning=True, error=False, blocking=True)",
                  strokes));
}

}  // namespace

std::string MakeUrScript(const std::vector<Stroke>& strokes, const PlanVerdict& verdict,
                         const SafetyGate& gate, const std::string& name) {
  SAND_CHECK(verdict.accepted && verdict.strokes.size() == strokes.size(), verdict.strokes.size(),
             strokes.size());
  CheckProgramName(name);
  UrScriptWriter writer(gate);
  WriteHead(gate.workcell(), strokes.size(), writer);
  for (size_t i = 0; i < strokes.size(); ++i) {
    writer.Comment(fmt::format("stroke {}: {:.1f} s, branch {}", i, verdict.strokes[i].duration_s,
                               verdict.strokes[i].branch));
    writer.StrokeMoves(strokes[i], *verdict.strokes[i].motion);
  }
  writer.Comment("home");
  writer.Joints(gate.workcell().home());
  writer.Line("textmsg(\"Sandwright: all strokes done\")");
  return "def " + name + "():\n" + writer.Take() + "end\n";
}

}  // namespace sandwright
