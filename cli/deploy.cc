// sandwright deploy: runs strokes on a rig: gate, motion, rescan, compare, next or stop.
#include <spdlog/fmt/fmt.h>

#include <filesystem>

#include "agents/load_agent.h"
#include "cli/command.h"
#include "cli/deploy_run.h"
#include "cli/verdict_files.h"
#include "data/base/error.h"
#include "data/base/stop.h"

namespace sandwright {
namespace {

class DeployCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--arm", request_.arm, "`simulated`, or the controller's address")
        ->capture_default_str();
    app.add_flag("--armed", request_.armed, "allow another address than loopback");
    app.add_option("--plan", request_.plan, "sealed plan (YAML); see check --seal");
    app.add_option("--terrain", request_.terrain,
                   "the scan that the plan was sealed for; the bed of a simulated arm");
    app.add_option("--agent", request_.agent, std::string("or: ") + kAgentNames);
    app.add_option("--goal", request_.goal, "height map that the agent is to reach");
    app.add_option("--model", request_.model, "sand model that predicts each stroke")
        ->capture_default_str();
    app.add_option("--world", request_.world, "sand model under a simulated arm")
        ->capture_default_str();
    app.add_option("--workcell", request_.workcell, "workcell file (default: the shipped one)");
    app.add_option("--mode", request_.mode,
                   "preview: the gate and a picture; simulate: on the simulated arm; dry-run: lifted "
                   "and slow; step: a yes before each stroke; run; recover: lift a buried blade")
        ->check(CLI::IsMember({"preview", "simulate", "dry-run", "step", "run", "recover"}))
        ->capture_default_str();
    app.add_option("--max-strokes", request_.max_strokes, "budget")
        ->check(CLI::Range(1, 10000))
        ->capture_default_str();
    app.add_option("--log", request_.log, "folder for the log: all that was done, seen and judged");
    app.add_option("--resume", resume_, "a log to go on with, beginning with a new scan");
    app.add_option("--replay", replay_, "a log to show again; nothing moves");
    app.add_option("--verdict", request_.verdict, "of plan --verdict (JSON): the end is compared with it; with --goal");
    app.add_option("--picture", picture_, "of a preview (PNG)");
  }
  void Fields(FieldList& f) override { settings_.Fields(f), UnattendedFields(f); }

  int Run() override {
    if (!replay_.empty()) return WriteResult(ReplayLog(replay_)), 0;
    if (!resume_.empty()) {
      const DeployRequest asked = request_;
      request_ = ReadDeployRequest(resume_);
      request_.armed = asked.armed;
      request_.mode = asked.mode == "recover" ? asked.mode : request_.mode;
    } else {
      request_.seed = seed();
    }
    request_.threads = threads();
    CheckRequest();
    if (request_.mode == "preview") return ShowPreview();
    const Deployment done = RunDeploy(request_, settings_, WatchFolder(request_.log));
    const std::string goal = fmt::format(", goal error {:.2f} -> {:.2f} mm",
                                         1e3 * done.start_error_m, 1e3 * done.end_error_m);
    Say(fmt::format("{}: {} strokes{}; log: {}", done.Outcome(), done.strokes.size(),
                    request_.goal.empty() ? "" : goal, request_.log));
    if (!done.outcome.is_null()) fmt::print("{}\n", OutcomeInWords(done.outcome));
    WriteResult(ToJson(done));
    ThrowIfStopRequested();
    return done.ok ? 0 : 3;
  }

 private:
  void CheckRequest() const {
    const bool plan = !request_.plan.empty(), agent = !request_.agent.empty();
    if (request_.mode != "recover" && plan == agent)
      throw Error("deploy needs either --plan FILE or --agent NAME with --goal FILE");
    if (plan && request_.terrain.empty())
      throw Error("--plan needs --terrain: the scan that it was sealed for");
    if (agent && request_.goal.empty()) throw Error("--agent needs --goal");
    if (!request_.verdict.empty() && request_.goal.empty()) throw Error("--verdict needs --goal");
    if (request_.mode == "preview" && !plan) throw Error("--mode preview needs --plan");
    if (request_.mode != "preview" && request_.log.empty())
      throw Error("deploy needs --log DIR: nothing moves without a log");
  }

  int ShowPreview() {
    const nlohmann::json verdict = Preview(request_, picture_);
    fmt::print("{} strokes, {}\n", verdict["strokes"].size(),
               verdict["accepted"].get<bool>() ? "accepted" : "REJECTED");
    for (const auto& reason : verdict["reasons"]) fmt::print("  - {}\n", reason.get<std::string>());
    WriteResult(verdict);
    return verdict["accepted"].get<bool>() ? 0 : 3;
  }

  DeployRequest request_;
  DeploySettings settings_;
  std::string resume_, replay_, picture_;
};

}  // namespace

std::unique_ptr<Command> MakeDeployCommand() { return std::make_unique<DeployCommand>(); }

}  // namespace sandwright
