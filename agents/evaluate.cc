#include "agents/evaluate.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <memory>

#include "data/base/error.h"
#include "data/base/stop.h"
#include "data/picture.h"

namespace sandwright {
namespace {

constexpr double kPictureError_m = 0.012;
constexpr int kPicturePixels = 300;  // about, a side

double SecondsOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// The names of `eval` differ from the metrics' only where a mean is a rate or a table.
nlohmann::json MetricsToJson(const std::map<std::string, double>& metrics) {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [name, value] : metrics) {
    if (name.starts_with("error_after_")) continue;
    json[name == "success" ? "success_rate" : name] = value;
  }
  for (const char* strokes : {"5", "10", "20"})
    json["error_after_mm"][strokes] = metrics.at(fmt::format("error_after_{}_mm", strokes));
  return json;
}

std::vector<EpisodeState> StartAll(const SandModel& sand, std::span<const Task> tasks, const EpisodeConfig& config,
                                   uint64_t seed) {
  std::vector<EpisodeState> episodes;
  for (size_t i = 0; i < tasks.size(); ++i) {
    const RandomStream noise(seed, StreamId("evaluation noise"), i);
    episodes.push_back(StartEpisode(sand, std::make_shared<const Task>(tasks[i]), config, noise));
  }
  return episodes;
}

}  // namespace

double Evaluation::Mean(const std::string& metric) const {
  double sum = 0;
  for (const auto& metrics : per_task) sum += metrics.at(metric);
  return sum / static_cast<double>(per_task.size());
}

nlohmann::json Evaluation::ToJson() const {
  std::map<std::string, double> means;
  for (const auto& [name, value] : per_task.at(0)) means[name] = Mean(name);
  nlohmann::json json = MetricsToJson(means);
  json["agent"] = agent;
  json["world"] = world;
  json["tasks"] = per_task.size();
  json["stopped"] = stopped;
  const double count = std::max(strokes, 1.0);
  json["model_evaluations_per_stroke"] = model_evaluations / count;
  json["ms_per_stroke_agent"] = 1e3 * agent_s / count;
  json["ms_per_stroke_world"] = 1e3 * world_s / count;
  for (const auto& metrics : per_task) json["per_task"].push_back(MetricsToJson(metrics));
  return json;
}

Evaluation Evaluate(Agent& agent, const World& world, const EpisodeConfig& config,
                    std::span<const Task> tasks, uint64_t seed,
                    const std::function<void(int64_t)>& progress) {
  if (tasks.empty()) throw Error("no tasks to evaluate on");
  Evaluation result;
  result.agent = agent.name();
  result.world = world.sand.name();
  std::vector<EpisodeState> episodes = StartAll(world.sand, tasks, config, seed);
  std::vector<RandomStream> streams;
  for (size_t i = 0; i < tasks.size(); ++i)
    streams.emplace_back(seed, StreamId("evaluation actions"), i);
  const int64_t evaluations_before = agent.model_evaluations();
  int64_t strokes = 0;
  for (;;) {
    std::vector<size_t> running;
    for (size_t i = 0; i < episodes.size(); ++i)
      if (!episodes[i].ended()) running.push_back(i);
    result.stopped = StopRequested();
    if (running.empty() || result.stopped) break;
    std::vector<TaskView> views;
    std::vector<RandomStream> drawing;
    for (size_t i : running) views.push_back(View(episodes[i], world.gate)), drawing.push_back(streams[i]);
    std::vector<Action> chosen, actions(episodes.size());
    result.agent_s += SecondsOf([&] { chosen = agent.Act(views, drawing); });
    for (size_t k = 0; k < running.size(); ++k) {
      actions[running[k]] = chosen[k];
      streams[running[k]] = drawing[k];
    }
    result.world_s += SecondsOf([&] { StepEpisodes(world, config, episodes, actions); });
    strokes += static_cast<int64_t>(running.size());
    if (progress) progress(strokes);
  }
  for (const EpisodeState& episode : episodes) {
    result.per_task.push_back(EpisodeMetrics(episode, config));
    result.end.push_back(episode.sand.map());
  }
  result.strokes = static_cast<double>(strokes);
  result.model_evaluations = static_cast<double>(agent.model_evaluations() - evaluations_before);
  return result;
}

cv::Mat DrawTask(const Task& task, const HeightMap& end) {
  const auto range = std::ranges::minmax(task.terrain.height_m);
  const int scale = std::max(1, kPicturePixels / std::max(end.rows, end.columns));
  const auto heights = [&](const HeightMap& map) {
    return DrawHeights(map, range.min, range.max, scale);
  };
  const auto error = [&](const HeightMap& map) {
    return DrawDifference(map, task.goal, kPictureError_m, scale);
  };
  const cv::Mat parts[] = {heights(task.terrain), heights(task.goal), heights(end),
                           error(task.terrain), error(end)};
  cv::Mat row;
  cv::hconcat(parts, std::size(parts), row);
  return row;
}

void DrawEvaluation(const Evaluation& evaluation, std::span<const Task> tasks,
                    const std::filesystem::path& folder) {
  SAND_CHECK(evaluation.end.size() == tasks.size());
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) throw Error("cannot make folder " + folder.string() + ": " + failure.message());
  for (size_t i = 0; i < tasks.size(); ++i)
    WritePicture(DrawTask(tasks[i], evaluation.end[i]), folder / fmt::format("task_{:05}.png", i));
}

EpisodeConfig EpisodeConfigFor(const Agent& agent, EpisodeConfig config) {
  if (const auto size = agent.region_size_m()) {
    config.region_width_m = (*size)[0];
    config.region_depth_m = (*size)[1];
  }
  return config;
}

}  // namespace sandwright
