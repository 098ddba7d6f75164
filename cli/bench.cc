// sandwright bench: speed, and speed against error, side by side on this machine.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>

#include "agents/agent_bench.h"
#include "agents/agent_strip.h"
#include "cli/command.h"
#include "cli/svg_chart.h"
#include "data/base/atomic_file.h"
#include "data/base/progress.h"
#include "data/base/sha256.h"
#include "data/picture.h"
#include "data/shipped.h"
#include "data/stroke_dataset.h"
#include "env/env_bench.h"
#include "env/grain_checks.h"
#include "env/load_sand_model.h"
#include "env/random_strokes.h"
#include "env/reference_bench.h"
#include "env/sand_bench.h"
#include "env/stress_rollouts.h"
#include "robot_model/arm_bench.h"

namespace sandwright {
namespace {

std::string Cell(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

constexpr const char* kColours[] = {"#888888", "#1f6fb2", "#c8501e", "#2a8a4a", "#7a4fb0",
                                    "#b5892b", "#d0548f", "#222222", "#4ab8b0"};

class BenchCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option(
           "--suite", suites_,
           "what to measure, one or several: sand; agents (on --tasks); env (the shaping environment, then reference); "
           "reference (Gymnasium's tasks); grains (a check of "
           "the grains, slow) and coarse (coarser grains on --data, slow), which need LAMMPS; hard (random strokes); surrogate "
           "(rollouts of --model on the worst beds); arm (kinematics, gate, reach of --workcell); all")
        ->check(CLI::IsMember({"sand", "agents", "arm", "env", "reference", "grains", "coarse", "hard", "surrogate", "all"}))
        ->capture_default_str();
    app.add_option("--data", data_, "stroke files or folders: errors on recorded strokes too");
    app.add_option("--strokes", strokes_,
                   "random strokes; suite arm: 2000, hard: 100000, surrogate: 1000 where not given; env: of each scene and "
                   "world, none where not given")
        ->check(CLI::PositiveNumber);
    app.add_option("--model", bench_.models,
                   "models, one or several: scored on --data by suite sand; of suite surrogate")
        ->capture_default_str();
    app.add_option("--tasks", tasks_file_, "task file of suite agents");
    app.add_option("--agents", agents_.agents,
                   "agents, one or several, compared with the first; NAME@N: planner NAME with N model "
                   "evaluations a stroke")
        ->capture_default_str();
    app.add_option("--world", world_, "sand model that executes the agents' strokes")->capture_default_str();
    app.add_option("--planner-model", planner_model_, "sand model that the agents plan with (default: --world's)");
    app.add_option("--keep", keep_,
                   "folder where suite agents keeps each stroke, one task after the other; the same call goes on "
                   "where it was stopped (a stroke through grains takes half a minute)");
    app.add_option("--workcell", workcell_, "of suite arm (default: the shipped one)");
    app.add_option("--picture", picture_,
                   "speed against error on --data, or of --agents (.svg); of suite arm: its reach (.png)");
    app.add_option("--strip", strip_, "one task by each of --agents (.png)")->needs("--tasks");
    app.add_option("--strip-task", strip_task_, "which of --tasks, from 0")->check(CLI::NonNegativeNumber);
    app.add_option("--with", earlier_,
                   "results of earlier runs (.json): their rows on recorded strokes, or of agents, join "
                   "the picture and the result, for what is slow to measure")
        ->check(CLI::ExistingFile);
    app.add_option("--floor-mm", floor_mm_, "noise floor to draw into the picture [mm]");
  }
  void Fields(FieldList& f) override {
    f.Section("heightfield", bench_.heightfield);
    f.Section("dem", bench_.dem);
    f.Section("episode", agents_.episode);
    planners_.Fields(f);
  }

  int Run() override {
    bench_.threads = threads();
    if (!data_.empty()) bench_.data = FindStrokeFiles(data_);
    if (Wants("sand")) RunSand();
    if (Wants("agents") && (!tasks_file_.empty() || !Wants("all"))) RunAgents();
    if (Wants("arm")) RunArm();
    if (Wants("env")) RunEnv();
    if (Wants("env") || Wants("reference")) RunReference();
    if (Wants("coarse")) RunCoarse();
    if (Wants("grains")) RunGrains();
    if (Wants("hard")) RunHard();
    if (Wants("surrogate")) {
      for (const std::string& model : bench_.models) RunSurrogate(model);
    }
    for (const std::string& file : earlier_) TakeRows(file);
    if (!picture_.empty() && suites_ != std::vector<std::string>{"arm"})
      WriteFileAtomically(picture_, DrawChartFile(agents_chart_.series.empty() ? SpeedAgainstError()
                                                                               : agents_chart_));
    WriteResult({{"rows", rows_}});
    return 0;
  }

 private:
  bool Wants(const char* suite) const {
    return std::ranges::any_of(suites_, [&](const auto& s) { return s == suite || s == "all"; });
  }

  void RunSand() {
    PrintSandHead();
    RunSandBench(bench_, [this](const SandBenchRow& row) { Add("sand", row); });
  }

  SandModelConfig Sand() const {
    SandModelConfig sand;
    sand.heightfield = bench_.heightfield;
    sand.dem = bench_.dem;
    return sand;
  }

  void RunEnv() {
    EnvBench bench;
    bench.sand = Sand();
    bench.threads = threads();
    bench.random_steps = strokes_.value_or(0);
    RunEnvBench(bench, [this](const nlohmann::json& row) { Show("env", row); });
  }

  void RunReference() {
    constexpr double kSeconds = 2;
    RunReferenceBench(kSeconds, [this](const nlohmann::json& row) { Show("reference", row); });
  }

  void RunArm() {
    const SafetyGate gate(
        LoadWorkcell(workcell_.empty() ? ShippedConfig("workcell.yaml").string() : workcell_));
    ArmBench bench{.seed = seed(), .threads = threads()};
    bench.strokes = strokes_.value_or(bench.strokes);
    RunArmBench(gate, bench, [this](const nlohmann::json& row) { Show("arm", row); });
    const ReachPicture reach = DrawReach(gate, threads());
    Show("arm", {{"name", "reach"},
                 {"share_of_box", reach.share_of_box},
                 {"share_inside_walls", reach.share_inside_walls}});
    if (!picture_.empty() && suites_.size() == 1) WritePicture(reach.picture, picture_);
  }

  void RunAgents() {
    if (tasks_file_.empty() && earlier_.empty()) throw Error("suite agents needs --tasks FILE");
    if (tasks_file_.empty()) return;
    agents_.tasks = ReadTasks(tasks_file_);
    agents_.seed = seed();
    if (strip_task_ >= agents_.tasks.size())
      throw Error(fmt::format("--strip-task {}: {} has {} tasks; allowed: 0..{}", strip_task_, tasks_file_,
                              agents_.tasks.size(), agents_.tasks.size() - 1));
    std::vector<AgentEnd> ends;
    if (planner_model_.empty()) planner_model_ = world_;
    const auto sand = LoadSandModel(world_, Sand()), model = LoadSandModel(planner_model_, Sand());
    if (!keep_.empty()) agents_.keep = KeptIn{keep_, SandSettings()};
    const AgentOptions options{*model, planners_, agents_.episode.speed_mps, "cpu", nullptr};
    fmt::print("{:20} {:>8} {:>9} {:>22} {:>22} {:>22}  above {} after 10\n", "agent", "calls", "ms",
               "mm after 5", "after 10", "after 20", agents_.agents.front());
    RunAgentBench(agents_, options, {*sand, nullptr, threads()}, [&](const AgentBenchRow& row) {
      const auto cell = [](const MeanOverTasks& m) {
        return fmt::format("{:.2f} [{:.2f}, {:.2f}]", m.mean, m.low95, m.high95);
      };
      fmt::print("{:20} {:8.0f} {:9.2f} {:>22} {:>22} {:>22}  {}\n", row.agent,
                 row.model_evaluations_per_stroke, row.ms_per_stroke, cell(row.error_mm[0]),
                 cell(row.error_mm[1]), cell(row.error_mm[2]), cell(row.above_first_mm[1]));
      std::fflush(stdout);
      DrawAgent(row.agent, row.ms_per_stroke, row.error_mm[1].mean);
      nlohmann::json json = row.ToJson();
      json["world"] = world_;
      json["planner_model"] = planner_model_;
      json["tasks"] = agents_.tasks.size();
      Keep("agents", std::move(json));
      ends.push_back({row.agent, row.end[strip_task_]});
    });
    if (!strip_.empty()) WritePicture(DrawAgentStrip(agents_.tasks[strip_task_], ends), strip_);
  }

  // What strokes depend on, without what changes only how fast they are.
  nlohmann::json SandSettings() const {
    SandModelConfig sand = Sand();
    sand.heightfield.threads = sand.dem.ranks = 1;
    sand.dem.cache.clear();
    nlohmann::json json = {{"world", world_}, {"planner_model", planner_model_}, {"sand", ToJson(FieldsOf(sand))}};
    for (const std::string& name : {world_, planner_model_}) {
      if (const auto file = ModelFileOf(name)) json["sha256"][name] = Sha256Hex(ReadFile(*file));
    }
    return json;
  }

  void DrawAgent(const std::string& name, double ms, double error_mm) {
    constexpr double kFastest_ms = 0.1;  // what is faster stands there
    const size_t colour = agents_chart_.series.size() % std::size(kColours);
    agents_chart_.series.push_back({.name = name,
                                    .x = {std::max(ms, kFastest_ms)},
                                    .y = {error_mm},
                                    .colour = kColours[colour]});
  }

  void Show(const char* suite, const nlohmann::json& row) {
    fmt::print("{}\n", row.dump());
    std::fflush(stdout);
    Keep(suite, row);
  }

  void RunCoarse() {
    PrintSandHead();
    RunGrainSizes(bench_, [this](const SandBenchRow& row) { Add("coarse", row); });
  }

  void RunGrains() {
    fmt::print("{:62} {:>10} {:>8} {:>8} {:6} {:>5} {:>7}\n", "grains", "measured", "low", "high",
               "unit", "holds", "s");
    RunGrainChecks(bench_.dem, [this](const GrainCheck& check, double s) { Add(check, s); });
  }

  void RunHard() {
    const int64_t strokes = strokes_.value_or(100000);
    Progress progress("hard", strokes, "strokes");
    const RandomStrokeTally tally =
        RunRandomStrokes(bench_.heightfield, strokes, seed(), threads(), [&](const auto& so_far) {
          progress.Update(static_cast<int>(so_far.strokes), so_far.sound() ? "sound" : "BROKEN");
        });
    nlohmann::json row = tally.ToJson();
    fmt::print("{} random strokes: {}\n", tally.strokes, row.dump());
    row["name"] = "random strokes";
    Keep("hard", std::move(row));
  }

  void RunSurrogate(const std::string& name) {
    const auto model = LoadSandModel(name, Sand());
    const StressConfig config{.strokes = strokes_.value_or(1000),
                              .repose_deg = bench_.heightfield.repose_deg,
                              .seed = seed(),
                              .threads = threads()};
    Progress progress("surrogate", config.strokes, "strokes");
    const auto tallies = RunStressRollouts(*model, config, [&](int64_t n) { progress.Update(n); });
    fmt::print("{:20} {:>8} {:>8} {:>5} {:>7} {:>9} {:>9} {:>9} {:>6} {:>6} {:>6} {:>9}\n", "bed",
               "strokes", "limited", "NaN", "< floor", "too high", "drift/1", "drift/all", "slope",
               "first", "last", "ms/stroke");
    for (const StressTally& t : tallies) {
      fmt::print(
          "{:20} {:8} {:8} {:5} {:7} {:9} {:9.1e} {:9.1e} {:6.2f} {:6.2f} {:6.2f} "
          "{:9.2f}\n",
          t.bed, t.strokes, t.limited, t.not_finite, t.below_floor, t.too_high, t.stroke_drift_rel,
          t.rollout_drift_rel, t.steepest, t.slope_first, t.slope_last, t.ms_per_stroke);
      nlohmann::json row = t.ToJson();
      row["model"] = name;
      Keep("surrogate", std::move(row));
    }
    RunDrift(name, *model);
  }

  void RunDrift(const std::string& name, const SandModel& model) {
    constexpr int kStrokes = 100;
    const BoxDrift drift = RunBoxDrift(model, Heightfield(bench_.heightfield), kStrokes, seed());
    nlohmann::json row = {{"name", "1200 x 800 mm, heightfield as truth"},
                          {"model", name},
                          {"volume_drift_rel", drift.volume_drift_rel},
                          {"ms_per_stroke", drift.ms_per_stroke}};
    for (const AccruedError& error : drift.difference.Accrued())
      row["rmse_mm"].push_back(error.rmse_mm);
    if (const auto exponent = drift.difference.GrowthExponent()) row["growth_exponent"] = *exponent;
    fmt::print(
        "{} strokes on 1200 x 800 mm, away from the heightfield by {:.2f} mm after 1, {:.2f} "
        "after 10, {:.2f} after 100; volume drift {:.1e}\n",
        kStrokes, row["rmse_mm"][0].get<double>(), row["rmse_mm"][9].get<double>(),
        row["rmse_mm"][99].get<double>(), drift.volume_drift_rel);
    Keep("surrogate", std::move(row));
  }

  // Of the rows on recorded strokes.
  Chart SpeedAgainstError() const {
    Chart chart{.x_label = "one stroke on one core [ms]",
                .y_label = "RMSE [mm]",
                .reference_y = floor_mm_,
                .reference_name = "what two packings of the same bed leave open",
                .logarithmic_x = true,
                .width_px = 760};
    for (const SandBenchRow& row : strokes_rows_) {
      const std::string name = row.name.substr(row.name.find(": ") + 2);
      if (name == "none") continue;  // so far off in both that nothing else could be told apart
      auto series = std::ranges::find(chart.series, name, &ChartSeries::name);
      if (series == chart.series.end()) {
        const size_t colour = chart.series.size() % std::size(kColours);
        chart.series.push_back({.name = name, .colour = kColours[colour]});
        series = chart.series.end() - 1;
      }
      series->x.push_back(row.ms_per_stroke);
      series->y.push_back(*row.rmse_mm);
    }
    if (chart.series.empty())
      throw Error("--picture needs errors on recorded strokes: give --data");
    return chart;
  }

  static void PrintSandHead() {
    fmt::print("{:38} {:>7} {:>8} {:>5} {:>10} {:>8} {:>8} {:>10} {:>9} {:>6}\n", "sand", "cell mm",
               "threads", "batch", "ms/stroke", "RMSE mm", "MAE mm", "RMSE cells", "max cells",
               "r2");
  }

  void Add(const char* suite, const SandBenchRow& row) {
    fmt::print("{:38} {:7g} {:8} {:5} {:10.3f} {:>8} {:>8} {:>10} {:>9} {:>6}\n", row.name,
               1e3 * row.cell_size_m, row.threads, row.batch, row.ms_per_stroke,
               Cell(row.rmse_mm, 3), Cell(row.mae_mm, 3), Cell(row.rmse_cells, 4),
               Cell(row.max_cells, 3), Cell(row.r2_change, 3));
    std::fflush(stdout);
    if (row.r2_change) strokes_rows_.push_back(row);
    Keep(suite, row.ToJson());
  }

  void Add(const GrainCheck& check, double seconds) {
    const auto limit = [&](double value) {
      return Cell(check.limited() ? std::optional(value) : std::nullopt, 3);
    };
    fmt::print("{:62} {:10.4g} {:>8} {:>8} {:6} {:>5} {:7.1f}\n", check.name, check.measured,
               limit(check.low), limit(check.high), check.unit,
               check.limited() ? (check.holds() ? "yes" : "NO") : "-", seconds);
    std::fflush(stdout);
    nlohmann::json json = check.ToJson();
    json["seconds"] = seconds;
    Keep("grains", std::move(json));
  }

  // The rows on recorded strokes, and of agents, of an earlier result.
  void TakeRows(const std::string& file) {
    const nlohmann::json result = nlohmann::json::parse(ReadFile(file), nullptr, false);
    if (!result.is_object() || !result.contains("rows"))
      throw Error(file + ": not a result of bench (no rows)");
    for (const nlohmann::json& row : result["rows"]) {
      if (row.value("suite", "") == "agents") {
        DrawAgent(row.at("agent"), row.at("ms_per_stroke_agent"), row.at("error_after_mm").at("10").at("mean"));
        rows_.push_back(row);
      }
      if (!row.contains("r2_change") || !row.contains("rmse_mm")) continue;
      strokes_rows_.push_back({.name = row.at("name"),
                               .ms_per_stroke = row.at("ms_per_stroke"),
                               .rmse_mm = row.at("rmse_mm").get<double>()});
      rows_.push_back(row);
    }
  }
  void Keep(const char* suite, nlohmann::json row) {
    row["suite"] = suite;
    rows_.push_back(std::move(row));
  }

  std::vector<std::string> suites_ = {"sand"};
  std::vector<std::string> data_;
  std::optional<int64_t> strokes_;
  std::vector<std::string> earlier_;
  std::string picture_, strip_, workcell_;
  size_t strip_task_ = 0;
  std::optional<double> floor_mm_;
  std::vector<SandBenchRow> strokes_rows_;
  SandBench bench_;
  std::string tasks_file_, world_ = "heightfield", planner_model_, keep_;
  AgentBench agents_;
  PlannerConfigs planners_;
  Chart agents_chart_{.x_label = "choosing a stroke [ms] (0.1 and less at the left)",
                      .y_label = "goal error after 10 strokes [mm]",
                      .logarithmic_x = true,
                      .width_px = 900};
  nlohmann::json rows_ = nlohmann::json::array();
};

}  // namespace

std::unique_ptr<Command> MakeBenchCommand() { return std::make_unique<BenchCommand>(); }

}  // namespace sandwright
