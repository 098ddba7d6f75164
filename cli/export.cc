// sandwright export: a sealed plan as a URScript program, through the gate.
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "cli/command.h"
#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/height_map.h"
#include "robot_model/plan.h"
#include "robot_model/urscript.h"

namespace sandwright {
namespace {

class ExportCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--plan", plan_file_, "sealed plan (YAML); see check --seal")->required();
    app.add_option("--terrain", terrain_file_, "height map that the plan was sealed for")
        ->required();
    app.add_option("--workcell", workcell_file_, "workcell (YAML)")->required();
    app.add_option("--out", out_, "URScript file to write (.script)")->required();
  }

  int Run() override {
    const HeightMap terrain = ReadHeightMap(terrain_file_);
    const Workcell workcell = LoadWorkcell(workcell_file_);
    const Plan plan = ReadSealedPlan(plan_file_, workcell, terrain);
    const SafetyGate gate(workcell);
    const PlanVerdict verdict = CheckPlan(gate, plan.strokes, terrain);
    if (!verdict.accepted) throw Error(plan_file_, verdict.reasons);
    const std::string script =
        MakeUrScript(plan.strokes, verdict, gate, "sandwright_" + plan.seal->seal.substr(0, 8));
    WriteFileAtomically(out_, script);
    const auto lines = std::ranges::count(script, '\n');
    fmt::print("{} strokes, {} lines: {}\n", plan.strokes.size(), lines, out_);
    nlohmann::json result = ToJson(verdict, workcell);
    result["out"] = out_;
    result["lines"] = lines;
    WriteResult(result);
    return 0;
  }

 private:
  std::string plan_file_, terrain_file_, workcell_file_, out_;
};

}  // namespace

std::unique_ptr<Command> MakeExportCommand() { return std::make_unique<ExportCommand>(); }

}  // namespace sandwright
