// Agents side by side on the same tasks: error after 5, 10 and 20 strokes, with intervals over tasks,
// and what a decision costs.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "agents/kept_evaluation.h"
#include "agents/load_agent.h"

namespace sandwright {

struct AgentBench {
  // Names as LoadAgent takes them; NAME@N gives a planner N model evaluations a stroke. All others are
  // compared with the first.
  std::vector<std::string> agents = {"default", "ranked", "greedy", "cem", "ga", "sweep",
                                     "boustrophedon", "random"};
  std::vector<Task> tasks;
  EpisodeConfig episode = {};
  uint64_t seed = 0;
  // Each stroke is kept in a folder of its agent below this one, and what is there is not executed again
  // (EvaluateKept). `settings`: of the world and the model that agents plan with.
  std::optional<KeptIn> keep = {};
};

// A mean over tasks with its 95 % interval: percentile bootstrap, tasks drawn with replacement.
struct MeanOverTasks {
  double mean = 0, low95 = 0, high95 = 0;
};
// `values` is not empty. The same seed gives the same figures.
MeanOverTasks MeanWithInterval(std::span<const double> values, uint64_t seed);

struct AgentBenchRow {
  std::string agent;
  double model_evaluations_per_stroke = 0, ms_per_stroke = 0;
  // After 5, 10 and 20 strokes (the end, where a task ended before) [mm].
  std::array<MeanOverTasks, 3> error_mm = {};
  std::array<MeanOverTasks, 3> above_first_mm = {};  // task by task: the error less the first agent's
  std::vector<std::array<double, 3>> per_task_mm;
  std::vector<HeightMap> end;  // of each task
  nlohmann::json ToJson() const;
};

// Plays all agents one after the other; `report` gets each row as it is there. `options.planners` holds
// the settings of all but NAME@N's number. Throws Error as LoadAgent does, before anything is played,
// and where N is not a number or NAME has no budget. After Ctrl-C the row that is played is not reported.
void RunAgentBench(const AgentBench& bench, const AgentOptions& options, const World& world,
                   const std::function<void(const AgentBenchRow&)>& report);

}  // namespace sandwright
