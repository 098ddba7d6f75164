// How far reality lies outside of what several sand models say: the factors of VerdictConfig and their coverage.
//   verdict_calibration OUT.json TASKS.h5 GRAINS_FOLDER [BED.h5...]
// GRAINS_FOLDER is what `bench --suite agents --world dem --keep` left: there the agent looked after each stroke. BEDs
// are recorded strokes that nobody aimed at a goal, played without a look, against goals of all kinds.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "agents/evaluate.h"
#include "agents/load_agent.h"
#include "agents/verdict.h"
#include "data/base/atomic_file.h"
#include "data/base/machine.h"
#include "data/stroke_dataset.h"
#include "env/load_sand_model.h"
#include "env/task_generator.h"

namespace sandwright {
namespace {

namespace fs = std::filesystem;

// A bed's (or task's) outcome beside what the worlds said.
struct PlayedOut {
  std::string bed, what;
  std::vector<double> world_mm;
  double real_mm = 0;
  double Low() const { return real_mm / std::ranges::min(world_mm); }
  double High() const { return real_mm / std::ranges::max(world_mm); }
};

using Worlds = std::vector<std::unique_ptr<SandModel>>;

Worlds LoadAll(const VerdictConfig& config) {
  Worlds worlds;
  for (const std::string& name : config.worlds) worlds.push_back(LoadSandModel(name, {}));
  return worlds;
}

std::vector<PlayedOut> FromAgents(const fs::path& folder, std::span<const Task> tasks, const Worlds& worlds) {
  std::vector<PlayedOut> found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.is_directory()) continue;
    const std::string name = entry.path().filename().string();
    for (size_t i = 0; i < tasks.size(); ++i) {
      const fs::path file = entry.path() / fmt::format("task_{:05}.h5", i);
      if (!fs::exists(file)) continue;
      const StrokeFile played = ReadStrokeFile(file);
      if (static_cast<int>(played.strokes.size()) != tasks[i].max_strokes) continue;
      const auto settings = nlohmann::json::parse(played.material);
      EpisodeConfig episode;
      LoadJson(FieldsOf(episode), settings.at("episode"), file.string());
      const auto model = LoadSandModel(settings.at("planner_model"), {});
      // The bed as it was scanned at first: that is what a verdict has.
      const Task task{played.strokes.front().before, tasks[i].goal, tasks[i].max_strokes};
      PlayedOut outcome{fmt::format("task {}", i), name, {}, 1e3 * GoalError(played.strokes.back().after, task.goal)};
      for (const auto& world : worlds) {
        const auto agent = LoadAgent(name, {.model = *model});
        const Evaluation end = Evaluate(*agent, {*world}, EpisodeConfigFor(*agent, episode), {&task, 1}, 1);
        outcome.world_mm.push_back(1e3 * ErrorAsScanned(task.terrain, end.end.front(), task.goal));
      }
      fmt::print("{} {}: real {:.2f} mm, worlds {:.2f} to {:.2f}\n", name, outcome.bed, outcome.real_mm,
                 std::ranges::min(outcome.world_mm), std::ranges::max(outcome.world_mm));
      std::fflush(stdout);
      found.push_back(std::move(outcome));
    }
  }
  return found;
}

std::vector<PlayedOut> FromBeds(std::span<const fs::path> files, const Worlds& worlds) {
  constexpr double kCell_m = 0.004;
  std::vector<PlayedOut> found;
  for (size_t b = 0; b < files.size(); ++b) {
    const StrokeFile bed = ReadStrokeFile(files[b]);
    const HeightMap start = Resample(bed.strokes.front().before, kCell_m);
    const HeightMap end = Resample(bed.strokes.back().after, kCell_m);
    std::vector<HeightMap> ends;
    for (const auto& world : worlds) {
      SandState state = world->Start(start, 0);
      for (const StrokeRecord& stroke : bed.strokes) world->Apply({&state, 1}, {&stroke.path, 1});
      ends.push_back(state.map());
    }
    for (const std::string_view kind : kGoalNames) {
      RandomStream stream(b, StreamId("verdict goals"), static_cast<uint64_t>(&kind - kGoalNames.data()));
      TaskConfig config;
      config.goals = {std::string(kind)};
      const HeightMap goal = GenerateGoal(config, start, stream).goal;
      PlayedOut outcome{bed.bed, std::string(kind), {}, 1e3 * GoalError(end, goal)};
      for (const HeightMap& predicted : ends) outcome.world_mm.push_back(1e3 * ErrorAsScanned(start, predicted, goal));
      found.push_back(std::move(outcome));
    }
  }
  return found;
}

// The order statistic that a new outcome lies below with probability `share`, as far as n of them can say; the
// largest where they cannot.
double Quantile(std::vector<double> values, double share) {
  std::ranges::sort(values);
  const auto n = static_cast<double>(values.size());
  const double rank = std::clamp(std::ceil(share * (n + 1)), 1.0, n);
  return values[static_cast<size_t>(rank) - 1];
}

VerdictConfig Factors(std::span<const PlayedOut> outcomes) {
  std::vector<double> low, high;
  for (const PlayedOut& o : outcomes) low.push_back(-o.Low()), high.push_back(o.High());
  VerdictConfig config;
  config.low_factor = -Quantile(low, 0.95);
  config.high_factor = Quantile(high, 0.95);
  return config;
}

double Coverage(std::span<const PlayedOut> outcomes, const VerdictConfig& config) {
  const auto inside = std::ranges::count_if(outcomes, [&](const PlayedOut& o) {
    return IntervalOf(o.world_mm, config).holds(o.real_mm);
  });
  return static_cast<double>(inside) / static_cast<double>(outcomes.size());
}

// Each bed judged by factors from all the others.
double LeftOutCoverage(std::span<const PlayedOut> outcomes) {
  double inside = 0;
  for (const PlayedOut& o : outcomes) {
    std::vector<PlayedOut> others;
    std::ranges::copy_if(outcomes, std::back_inserter(others), [&](const PlayedOut& p) { return p.bed != o.bed; });
    inside += IntervalOf(o.world_mm, Factors(others)).holds(o.real_mm);
  }
  return inside / static_cast<double>(outcomes.size());
}

nlohmann::json Judge(const char* name, std::span<const PlayedOut> outcomes, const VerdictConfig& shipped) {
  if (outcomes.empty()) return nullptr;
  std::vector<std::string> beds;
  nlohmann::json rows = nlohmann::json::array();
  double relative_width = 0;
  const VerdictConfig fitted = Factors(outcomes);
  for (const PlayedOut& o : outcomes) {
    if (std::ranges::find(beds, o.bed) == beds.end()) beds.push_back(o.bed);
    const ErrorInterval interval = IntervalOf(o.world_mm, fitted);
    relative_width += (interval.high90_m - interval.low90_m) / interval.expected_m;
    rows.push_back({{"bed", o.bed}, {"what", o.what}, {"worlds_mm", o.world_mm}, {"real_mm", o.real_mm}});
  }
  nlohmann::json json = {{"n", outcomes.size()},
                         {"beds", beds.size()},
                         {"low_factor", fitted.low_factor},
                         {"high_factor", fitted.high_factor},
                         {"coverage_fitted", Coverage(outcomes, fitted)},
                         {"mean_width_over_expected", relative_width / static_cast<double>(outcomes.size())},
                         {"coverage_shipped_factors", Coverage(outcomes, shipped)},
                         {"outcomes", rows}};
  if (beds.size() > 1) json["coverage_leave_one_bed_out"] = LeftOutCoverage(outcomes);
  nlohmann::json shown = json;
  shown.erase("outcomes");
  fmt::print("{}: {}\n", name, shown.dump());
  return json;
}

int Run(const fs::path& out, const fs::path& tasks_file, const fs::path& grains, std::span<const fs::path> beds) {
  const VerdictConfig shipped;
  const Worlds worlds = LoadAll(shipped);
  const std::vector<Task> tasks = ReadTasks(tasks_file);
  const auto of_agents = FromAgents(grains, tasks, worlds), of_beds = FromBeds(beds, worlds);
  nlohmann::json result = {{"commit", BuildCommit()},
                           {"machine", MachineDescription()},
                           {"worlds", shipped.worlds},
                           {"shipped", {{"low_factor", shipped.low_factor}, {"high_factor", shipped.high_factor}}},
                           {"agents_among_grains", Judge("agents among grains", of_agents, shipped)},
                           {"recorded_beds", Judge("recorded beds", of_beds, shipped)}};
  WriteFileAtomically(out, result.dump(1) + "\n");
  return 0;
}

}  // namespace
}  // namespace sandwright

int main(int count, char** words) {
  if (count < 4) {
    fmt::print(stderr, "usage: verdict_calibration OUT.json TASKS.h5 GRAINS_FOLDER [BED.h5...]\n");
    return 2;
  }
  try {
    const std::vector<std::filesystem::path> beds(words + 4, words + count);
    return sandwright::Run(words[1], words[2], words[3], beds);
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return 1;
  }
}
