// How well an agent shapes: the same episodes as in training, scored task by task.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <span>
#include <string>
#include <vector>

#include "env/agent.h"
#include "env/episode.h"

namespace sandwright {

struct Evaluation {
  std::string agent, world;
  std::vector<std::map<std::string, double>> per_task;  // EpisodeMetrics of each task, in order
  std::vector<HeightMap> end;                           // the sand after the last stroke
  double strokes = 0;                                   // of all tasks
  double agent_s = 0, world_s = 0;                      // spent choosing and executing
  double model_evaluations = 0;
  bool stopped = false;  // by Ctrl-C: the metrics are those of the strokes so far

  // Mean of a metric over the tasks.
  double Mean(const std::string& metric) const;
  // The keys of `eval`, means over tasks and `per_task`.
  nlohmann::json ToJson() const;
};

// Plays every task to its end, all tasks side by side. The agent's randomness on task i and the
// sensor noise come from streams of (seed, purpose, i), so a task's result depends neither on the
// others nor on threads. `progress` gets the strokes so far. After Ctrl-C no further stroke is
// chosen.
Evaluation Evaluate(Agent& agent, const World& world, const EpisodeConfig& config,
                    std::span<const Task> tasks, uint64_t seed,
                    const std::function<void(int64_t)>& progress = {});

// One task from left to right: start, goal, end, error at the start and at the end (+-12 mm). BGR.
cv::Mat DrawTask(const Task& task, const HeightMap& end);

// DIR/task_NNNNN.png for each task.
void DrawEvaluation(const Evaluation& evaluation, std::span<const Task> tasks,
                    const std::filesystem::path& folder);

// `config` with the region that the agent was made for, where it was made for one.
EpisodeConfig EpisodeConfigFor(const Agent& agent, EpisodeConfig config);

}  // namespace sandwright
