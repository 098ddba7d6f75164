// sandwright plan: an agent's strokes for a terrain and a goal, each through the safety gate.
#include "robot_model/plan.h"

#include <spdlog/fmt/fmt.h>

#include "agents/closed_loop.h"
#include "agents/evaluate.h"
#include "agents/load_agent.h"
#include "cli/command.h"
#include "cli/verdict_files.h"
#include "data/base/stop.h"
#include "data/shipped.h"
#include "env/load_sand_model.h"

namespace sandwright {
namespace {

class PlanCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--agent", agent_, kAgentNames)->required();
    app.add_option("--model", model_, "sand model that predicts each stroke")
        ->capture_default_str();
    app.add_option("--terrain", terrain_, "height map of the whole box, datum floor")->required();
    app.add_option("--goal", goal_, "height map to reach; NaN or mask 0 = not counted")->required();
    app.add_option("--max-strokes", max_strokes_, "budget")
        ->check(CLI::Range(1, 10000))
        ->capture_default_str();
    app.add_option("--workcell", workcell_, "workcell file (default: the shipped one)");
    app.add_option("--out", out_, "plan file to write (.yaml)")->required();
    app.add_option("--verdict", verdict_file_,
                   "verdict to write (.json, and a picture .png beside it): how near the agent will come with a rescan "
                   "after each stroke, where it will miss and why, and how long the arm takes")
        ->check(IsVerdictFile);
  }
  void Fields(FieldList& f) override {
    f.Section("episode", episode_);
    sand_.Fields(f);
    planners_.Fields(f);
    f.Section("verdict", verdict_);
  }

  int Run() override {
    sand_.heightfield.threads = threads();
    const auto model = LoadSandModel(model_, sand_);
    const SafetyGate gate(
        LoadWorkcell(workcell_.empty() ? ShippedConfig("workcell.yaml").string() : workcell_));
    const auto agent = LoadAgent(
        agent_,
        {.model = *model, .planners = planners_, .speed_mps = episode_.speed_mps, .gate = &gate});
    const Task task{ReadHeightMap(terrain_), ReadGoal(goal_), max_strokes_};
    CheckTask(task, goal_);
    const ShapingJob job{.terrain = task.terrain,
                         .goal = task.goal,
                         .region = RegionOf(task, EpisodeConfigFor(*agent, episode_)),
                         .max_strokes = max_strokes_,
                         .speed_mps = episode_.speed_mps,
                         .success_error_m = episode_.success_error_m};
    const ShapingRun run = RunClosedLoop(*agent, *model, gate, job, RandomStream(seed(), StreamId("plan")));
    Plan plan;
    nlohmann::json strokes = nlohmann::json::array();
    for (const ShapingStroke& stroke : run.strokes) {
      if (stroke.verdict.accepted) plan.strokes.push_back(stroke.stroke);
      strokes.push_back({{"accepted", stroke.verdict.accepted},
                         {"reasons", stroke.verdict.reasons},
                         {"in_goal_mean_diff_mm", 1e3 * stroke.goal_error_m},
                         {"duration_s", stroke.verdict.duration_s}});
    }
    nlohmann::json result = {{"agent", agent->name()},
                             {"model", model->name()},
                             {"strokes", strokes},
                             {"rejected_strokes", run.rejected()},
                             {"stopped", run.stopped},
                             {"in_goal_mean_diff_start_mm", 1e3 * run.start_error_m},
                             {"in_goal_mean_diff_mm", 1e3 * run.final_error_m()}};
    if (plan.strokes.empty() && !run.strokes.empty())
      throw Error("the gate rejected every stroke", run.strokes.back().verdict.reasons);
    if (plan.strokes.empty()) ThrowIfStopRequested();
    WritePlan(plan, out_);
    fmt::print("{} strokes ({} rejected), goal error {:.2f} -> {:.2f} mm as predicted by {}: {}\n",
               plan.strokes.size(), run.rejected(), 1e3 * run.start_error_m,
               1e3 * run.final_error_m(), model->name(), out_);
    if (!verdict_file_.empty() && !run.stopped) {
      const Verdict verdict = MakeVerdict(*agent, *model, LoadWorlds(verdict_, sand_), gate, job, seed(), verdict_);
      result["verdict"] = WriteVerdict(verdict, job, verdict_, verdict_file_);
    }
    WriteResult(result);
    return run.stopped ? 130 : 0;
  }

 private:
  std::string agent_, model_ = "heightfield", terrain_, goal_, workcell_, out_, verdict_file_;
  int max_strokes_ = 20;
  EpisodeConfig episode_;
  SandModelConfig sand_;
  PlannerConfigs planners_;
  VerdictConfig verdict_;
};

}  // namespace

std::unique_ptr<Command> MakePlanCommand() { return std::make_unique<PlanCommand>(); }

}  // namespace sandwright
