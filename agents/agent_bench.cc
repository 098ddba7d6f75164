#include "agents/agent_bench.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <numeric>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/sha256.h"

namespace sandwright {
namespace {

constexpr int kResamples = 10000;
constexpr std::array kMetrics = {"error_after_5_mm", "error_after_10_mm", "error_after_20_mm"};

double MeanOf(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// NAME or NAME@N: the name alone, with N in its section of `planners`.
std::string TakeBudget(const std::string& agent, PlannerConfigs& planners) {
  const size_t at = agent.find('@');
  if (at == std::string::npos) return agent;
  const std::string name = agent.substr(0, at), number = agent.substr(at + 1);
  const std::map<std::string, int64_t*> budgets = {{"greedy", &planners.greedy.evaluations},
                                                   {"cem", &planners.cem.evaluations},
                                                   {"ga", &planners.ga.evaluations},
                                                   {"ranked", &planners.ranked.evaluations}};
  const auto budget = budgets.find(name);
  int64_t evaluations = 0;
  const auto [end, failure] =
      std::from_chars(number.data(), number.data() + number.size(), evaluations);
  if (budget == budgets.end() || failure != std::errc() || *end != '\0' || evaluations < 1)
    throw Error(fmt::format("agent \"{}\"; allowed: greedy@N, cem@N, ga@N, ranked@N with N model "
                            "evaluations a stroke, 1 or more",
                            agent));
  *budget->second = evaluations;
  return name;
}

nlohmann::json ByStrokes(const std::array<MeanOverTasks, 3>& means) {
  nlohmann::json json;
  for (size_t k = 0; k < means.size(); ++k)
    json[std::array{"5", "10", "20"}[k]] = {{"mean", means[k].mean},
                                            {"low95", means[k].low95},
                                            {"high95", means[k].high95}};
  return json;
}

// Where the strokes of an agent are kept, and what they depend on beside world and model.
KeptIn KeptOf(const KeptIn& keep, const std::string& agent, const std::string& plain, PlannerConfigs planners) {
  KeptIn kept{keep.folder / std::filesystem::path(agent).stem(), keep.settings};
  const auto keys = ToJson(FieldsOf(planners));
  if (keys.contains(plain)) kept.settings["planner"] = keys[plain];
  if (const auto policy = PolicyFileOf(plain, planners)) kept.settings["policy_sha256"] = Sha256Hex(ReadFile(*policy));
  return kept;
}

}  // namespace

MeanOverTasks MeanWithInterval(std::span<const double> values, uint64_t seed) {
  SAND_CHECK(!values.empty());
  RandomStream stream(seed, StreamId("tasks drawn again"));
  std::vector<double> means(kResamples);
  for (double& mean : means) {
    for (size_t i = 0; i < values.size(); ++i) mean += values[stream.Index(values.size())];
    mean /= static_cast<double>(values.size());
  }
  std::ranges::sort(means);
  return {MeanOf(values), means[kResamples / 40], means[kResamples - 1 - kResamples / 40]};
}

nlohmann::json AgentBenchRow::ToJson() const {
  return {{"agent", agent},
          {"model_evaluations_per_stroke", model_evaluations_per_stroke},
          {"ms_per_stroke_agent", ms_per_stroke},
          {"error_after_mm", ByStrokes(error_mm)},
          {"above_first_mm", ByStrokes(above_first_mm)},
          {"per_task_error_after_5_10_20_mm", per_task_mm}};
}

void RunAgentBench(const AgentBench& bench, const AgentOptions& options, const World& world,
                   const std::function<void(const AgentBenchRow&)>& report) {
  std::vector<std::unique_ptr<Agent>> agents;
  std::vector<std::optional<KeptIn>> kept;
  for (const std::string& name : bench.agents) {
    AgentOptions own = options;
    const std::string plain = TakeBudget(name, own.planners);
    agents.push_back(LoadAgent(plain, own));
    kept.push_back(bench.keep ? std::optional(KeptOf(*bench.keep, name, plain, own.planners)) : std::nullopt);
  }
  std::vector<std::array<double, 3>> first;
  for (size_t a = 0; a < agents.size(); ++a) {
    const EpisodeConfig config = EpisodeConfigFor(*agents[a], bench.episode);
    const Evaluation played = kept[a] ? EvaluateKept(*agents[a], world, config, bench.tasks, bench.seed, *kept[a])
                                      : Evaluate(*agents[a], world, config, bench.tasks, bench.seed);
    if (played.stopped) return;
    AgentBenchRow row{.agent = bench.agents[a], .per_task_mm = {}, .end = played.end};
    const double strokes = std::max(played.strokes, 1.0);
    row.model_evaluations_per_stroke = played.model_evaluations / strokes;
    row.ms_per_stroke = 1e3 * played.agent_s / strokes;
    for (const auto& metrics : played.per_task)
      row.per_task_mm.push_back(
          {metrics.at(kMetrics[0]), metrics.at(kMetrics[1]), metrics.at(kMetrics[2])});
    if (a == 0) first = row.per_task_mm;
    for (size_t k = 0; k < kMetrics.size(); ++k) {
      std::vector<double> errors, differences;
      for (size_t i = 0; i < first.size(); ++i) {
        errors.push_back(row.per_task_mm[i][k]);
        differences.push_back(row.per_task_mm[i][k] - first[i][k]);
      }
      row.error_mm[k] = MeanWithInterval(errors, bench.seed);
      row.above_first_mm[k] = MeanWithInterval(differences, bench.seed);
    }
    report(row);
  }
}

}  // namespace sandwright
