#include "cli/deploy_run.h"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <iostream>

#include "agents/closed_loop.h"
#include "agents/evaluate.h"
#include "agents/load_agent.h"
#include "cli/verdict_files.h"
#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/picture.h"
#include "data/shipped.h"
#include "env/load_sand_model.h"
#include "robot_model/controller/ur_rig.h"
#include "robot_model/plan.h"

namespace sandwright {
namespace {

namespace fs = std::filesystem;

// A file of the request as the log keeps it, so that a run can be continued as it began.
std::string Kept(const std::string& file, const RigLog& log, const char* name) {
  if (file.empty()) return "";
  const fs::path copy = log.folder() / name;
  // What a start that came to nothing left here is not what is asked for now.
  if (!fs::exists(copy) || !fs::equivalent(copy, file)) WriteFileAtomically(copy, ReadFile(file));
  return copy.string();
}

Workcell CellOf(const DeployRequest& request) {
  return LoadWorkcell(request.workcell.empty() ? ShippedConfig("workcell.yaml").string()
                                               : request.workcell);
}

// The sealed plan, gated once more on the scan that it was made for.
Plan CheckedPlan(const DeployRequest& request, const SafetyGate& gate, const HeightMap& terrain) {
  Plan plan = ReadSealedPlan(request.plan, gate.workcell(), terrain);
  const PlanVerdict verdict = CheckPlan(gate, plan.strokes, terrain);
  if (!verdict.accepted) throw Error(request.plan, verdict.reasons);
  return plan;
}

bool AskAtKeyboard(const std::string& question) {
  fmt::print("{}. Keep clear. Go on? [y/N] ", question);
  std::fflush(stdout);
  std::string answer;
  return std::getline(std::cin, answer) && (answer == "y" || answer == "yes");
}

// Draws until the gate accepts one; there is none where it refuses all of them.
std::optional<Stroke> DrawAccepted(const ExcavationConfig& config, const SafetyGate& gate,
                                   const HeightMap& sensed, RandomStream& stream) {
  constexpr int kDraws = 1000;
  for (int draw = 0; draw < kDraws; ++draw) {
    Stroke stroke = DrawStroke(config, sensed, stream);
    if (gate.Check(stroke, sensed, GateSampling::kCoarse).accepted) return stroke;
  }
  return std::nullopt;
}

// Strokes of a run that is continued. Of a plan or an agent those that were begun, whatever became of
// them: nothing is sent twice. Of random ones those that are data.
int StrokesUsed(const DeployRequest& request) {
  if (!request.resume) return 0;
  if (request.plan.empty() && request.agent.empty()) {
    const fs::path file = fs::path(request.log) / "strokes.h5";
    return fs::exists(file) ? static_cast<int>(ReadStrokeFile(file).strokes.size()) : 0;
  }
  const auto events = RigLog::ReadEvents(request.log);
  return static_cast<int>(
      std::ranges::count_if(events, [](const auto& e) { return e["event"] == "choice"; }));
}

Deployment Recover(Rig& rig, const SafetyGate& gate, const ScanConfig& scan, RigLog& log) {
  LoggedRig logged(rig, log);
  RigDriver driver(logged, gate, scan);
  Deployment result{.end = "not confirmed", .reason = "the operator said no"};
  const double height_m = gate.kinematics().BladeInBox(rig.Joints()).translation().z();
  if (AskAtKeyboard(fmt::format(
          "lift the blade straight up, slowly, from {:.0f} mm above the floor", 1e3 * height_m))) {
    const Drive drive = driver.Lift();
    result.ok = drive.finished();
    result.end = result.ok ? "lifted" : drive.refused.empty() ? drive.execution->end : "refused";
    result.reason = drive.why();
  }
  log.Add("end", {{"end", result.end}, {"reason", result.reason}});
  return result;
}

// All that a run holds together.
class DeployRun {
 public:
  DeployRun(const DeployRequest& request, const DeploySettings& settings, RunStatus* status)
      : request_(request), settings_(settings), status_(status), gate_(CellOf(request)) {
    if (!request.terrain.empty()) terrain_ = ReadHeightMap(request.terrain);
    if (!request.goal.empty()) goal_ = ReadGoal(request.goal);
    if (goal_ && terrain_ && !goal_->SameGrid(*terrain_))
      throw Error(request.goal + ": the goal's grid is not the terrain's");
    if (goal_ || terrain_)
      settings_.deployment.scan.cell_size_m = (goal_ ? *goal_ : *terrain_).cell_size_m;
    if (!request.verdict.empty()) verdict_ = ReadVerdict(request.verdict, *goal_);
    settings_.sand.heightfield.threads = request.threads;
    model_ = LoadSandModel(request.model, settings_.sand);
    job_ = {.mode = request.mode == "dry-run" ? DeployMode::kDryRun : DeployMode::kRun,
            .max_strokes = request.max_strokes,
            .strokes_used = StrokesUsed(request),
            .goal = goal_,
            .success_error_m = settings.episode.success_error_m};
    stream_ = RandomStream(request.seed, StreamId("deploy"), StreamIndex());
  }

  Deployment Go() {
    if (!request_.plan.empty())
      FollowPlan();
    else if (!request_.agent.empty())
      FollowAgent();
    else
      source_ = [this](const HeightMap& sensed, int, int) {
        return DrawAccepted(settings_.excavation, gate_, sensed, stream_);
      };
    MakeRig();
    RigLog log(request_.log, request_.resume);
    Begin(log);
    if (request_.mode == "recover") return Recover(*rig_, gate_, settings_.deployment.scan, log);
    Deployment done = Deploy(*rig_, gate_, *model_, source_, job_, settings_.deployment,
                             request_.mode == "step" ? AskAtKeyboard : nullptr, log, status_);
    if (!verdict_.is_null() && done.ok && job_.mode == DeployMode::kRun)
      log.Add("outcome", done.outcome = CompareWithVerdict(verdict_, *goal_, done.end_error_m));
    return done;
  }

 private:
  uint64_t StreamIndex() const { return static_cast<uint64_t>(job_.strokes_used); }

  void FollowPlan() {
    const Plan plan = CheckedPlan(request_, gate_, terrain_.value());
    seal_ = plan.seal->seal;
    job_.planned = true;
    job_.planned_for = terrain_;
    source_ = [strokes = plan.strokes](const HeightMap&, int used, int) {
      return used < std::ssize(strokes) ? std::optional(strokes[static_cast<size_t>(used)])
                                        : std::nullopt;
    };
  }

  void FollowAgent() {
    agent_ = LoadAgent(request_.agent, {.model = *model_,
                                        .planners = settings_.planners,
                                        .speed_mps = settings_.episode.speed_mps,
                                        .gate = &gate_});
    const Region region = RegionOf({goal_.value(), *goal_, request_.max_strokes},
                                   EpisodeConfigFor(*agent_, settings_.episode));
    shaping_ = {.terrain = {},
                .goal = *goal_,
                .region = region,
                .max_strokes = request_.max_strokes,
                .speed_mps = settings_.episode.speed_mps};
    source_ = [this](const HeightMap& sensed, int used, int rejected) {
      return std::optional(ChooseStroke(*agent_, shaping_, sensed, used, rejected, gate_,
                                        model_->blade(), stream_));
    };
  }

  void MakeRig() {
    if (request_.arm != "simulated" && request_.mode != "simulate") {
      const ControllerPortSettings& ports = settings_.controller;
      const ControllerAddress address{request_.arm, static_cast<uint16_t>(ports.dashboard_port),
                                      static_cast<uint16_t>(ports.primary_port),
                                      static_cast<uint16_t>(ports.rtde_port)};
      rig_ = std::make_unique<UrRig>(address, gate_, request_.armed);
      return;
    }
    if (!terrain_) throw Error("--arm simulated needs --terrain: the bed that it stands over");
    const fs::path bed = fs::path(request_.log) / "bed.h5";
    world_ = LoadSandModel(request_.world, settings_.sand);
    rig_ = std::make_unique<SimulatedRig>(gate_.workcell(), *world_,
                                          fs::exists(bed) ? ReadHeightMap(bed) : *terrain_,
                                          settings_.rig,
                                          RandomStream(request_.seed, StreamId("rig"), StreamIndex()),
                                          bed);
  }

  // What the run began with, kept in the log so that it can be continued.
  void Begin(RigLog& log) {
    request_.plan = Kept(request_.plan, log, "plan.yaml");
    request_.terrain = Kept(request_.terrain, log, "terrain.h5");
    request_.goal = Kept(request_.goal, log, "goal.h5");
    request_.verdict = Kept(request_.verdict, log, "verdict.json");
    request_.workcell = (log.folder() / "workcell.yaml").string();
    Workcell cell = gate_.workcell();
    WriteFileAtomically(request_.workcell, ToYaml(FieldsOf(cell)));
    nlohmann::json begin = request_.ToJson();
    begin["rig"] = rig_->name();
    begin["workcell_hash"] = WorkcellHash(cell);
    begin["calibration_hash"] = CalibrationHash(cell);
    if (!seal_.empty()) begin["plan_seal"] = seal_;
    log.Add(request_.resume ? "resume" : "begin", begin);
  }

  DeployRequest request_;
  DeploySettings settings_;
  RunStatus* status_;
  SafetyGate gate_;
  std::optional<HeightMap> terrain_, goal_;
  nlohmann::json verdict_;  // null: none
  std::unique_ptr<SandModel> model_, world_;
  std::unique_ptr<Agent> agent_;
  std::unique_ptr<Rig> rig_;
  DeploymentJob job_;
  ShapingJob shaping_;
  RandomStream stream_{0};
  StrokeSource source_;
  std::string seal_;  // of the plan that is followed
};

}  // namespace

nlohmann::json DeployRequest::ToJson() const {
  return {{"arm", arm},     {"plan", plan},         {"terrain", terrain},
          {"agent", agent}, {"goal", goal},         {"model", model},
          {"world", world}, {"workcell", workcell}, {"mode", mode}, {"verdict", verdict},
          {"max_strokes", max_strokes}, {"seed", seed}};
}

DeployRequest ReadDeployRequest(const std::string& log) {
  const auto events = RigLog::ReadEvents(log);
  if (events.empty() || events.front()["event"] != "begin")
    throw Error(log + ": the log does not say how the run began");
  const nlohmann::json& begin = events.front();
  DeployRequest request;
  try {
    for (auto [key, value] : {std::pair{"arm", &request.arm}, {"plan", &request.plan},
                              {"terrain", &request.terrain}, {"agent", &request.agent},
                              {"goal", &request.goal}, {"model", &request.model},
                              {"world", &request.world}, {"workcell", &request.workcell},
                              {"mode", &request.mode}})
      *value = begin.at(key).get<std::string>();
    request.max_strokes = begin.at("max_strokes");
    request.seed = begin.at("seed");
    request.verdict = begin.value("verdict", "");  // not in older logs
  } catch (const nlohmann::json::exception& e) {
    throw Error(fmt::format("{}: the first event of the log: {}", log, e.what()));
  }
  request.log = log;
  request.resume = true;
  return request;
}

Deployment RunDeploy(const DeployRequest& request, const DeploySettings& settings,
                     RunStatus* status) {
  return DeployRun(request, settings, status).Go();
}

nlohmann::json Preview(const DeployRequest& request, const std::string& picture) {
  const SafetyGate gate(CellOf(request));
  const HeightMap terrain = ReadHeightMap(request.terrain);
  const Plan plan = ReadSealedPlan(request.plan, gate.workcell(), terrain);
  const PlanVerdict verdict = CheckPlan(gate, plan.strokes, terrain);
  if (!picture.empty()) {
    const auto [low, high] = std::ranges::minmax(terrain.height_m);
    const int scale = std::max(1, 900 / terrain.columns);
    cv::Mat image = DrawHeights(terrain, low, high, scale);
    for (const Stroke& stroke : plan.strokes)
      DrawPath(image, terrain, SamplePath(stroke, 0.002), gate.workcell().tool.blade, scale);
    WritePicture(image, picture);
  }
  return ToJson(verdict, gate.workcell());
}

nlohmann::json ReplayLog(const std::string& log) {
  nlohmann::json summary = {{"events", 0}, {"motions", 0}, {"scans", 0}, {"strokes", 0}};
  for (nlohmann::json event : RigLog::ReadEvents(log)) {
    const std::string name = event["event"], time = event.value("time", "");
    summary["events"] = summary["events"].get<int>() + 1;
    for (const auto& [of, counted] : {std::pair{"motion", "motions"}, {"scan", "scans"}, {"verdict", "strokes"}})
      if (name == of) summary[counted] = summary[counted].get<int>() + 1;
    if (name == "end") summary["end"] = event.value("end", ""), summary["reason"] = event.value("reason", "");
    event.erase("event");
    event.erase("time");
    fmt::print("{}  {:8} {}\n", time, name, event.dump());
  }
  return summary;
}

nlohmann::json ToJson(const Deployment& deployment) {
  nlohmann::json strokes = nlohmann::json::array();
  for (const DeployedStroke& stroke : deployment.strokes)
    strokes.push_back({{"accepted", stroke.refused.empty()},
                       {"reasons", stroke.refused},
                       {"end", stroke.end},
                       {"deviation_rad", stroke.deviation_rad},
                       {"in_goal_mean_diff_mm", 1e3 * stroke.goal_error_m},
                       {"rescan", ToJson(stroke.rescan)}});
  return {{"end", deployment.end},
          {"reason", deployment.reason},
          {"ok", deployment.ok},
          {"in_goal_mean_diff_start_mm", 1e3 * deployment.start_error_m},
          {"in_goal_mean_diff_mm", 1e3 * deployment.end_error_m},
          {"verdict", deployment.outcome},
          {"strokes", strokes}};
}

}  // namespace sandwright
