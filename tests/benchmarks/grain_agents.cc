// Agents among grains against the same agents in a model's world, from the strokes that `bench --keep` left:
//   grain_agents OUT.json TASKS.h5 GRAINS_FOLDER MODEL_FOLDER
// docs/shaping.md says what the figures mean.
#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "agents/agent_bench.h"
#include "data/base/atomic_file.h"
#include "data/base/machine.h"
#include "data/stroke_dataset.h"
#include "data/task.h"

namespace sandwright {
namespace {

namespace fs = std::filesystem;

// Strokes of an agent on its tasks; a task that is not finished is left out.
std::map<size_t, StrokeFile> Played(const fs::path& folder, std::span<const Task> tasks) {
  std::map<size_t, StrokeFile> played;
  for (size_t i = 0; i < tasks.size(); ++i) {
    const fs::path file = folder / fmt::format("task_{:05}.h5", i);
    if (!fs::exists(file)) continue;
    StrokeFile strokes = ReadStrokeFile(file);
    if (static_cast<int>(strokes.strokes.size()) == tasks[i].max_strokes) played.emplace(i, std::move(strokes));
  }
  return played;
}

double Mean(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Mean over the goal's cells of |end - goal + rough|; of end - goal where `absolute` is not set.
double ErrorOver_mm(const HeightMap& end, const HeightMap& goal, const HeightMap* bed, const HeightMap* terrain,
                    bool absolute = true) {
  double sum = 0, counted = 0;
  for (size_t i = 0; i < end.size(); ++i) {
    if (!goal.mask[i]) continue;
    const double rough = bed ? static_cast<double>(bed->height_m[i]) - terrain->height_m[i] : 0;
    const double error = end.height_m[i] - goal.height_m[i] + rough;
    sum += absolute ? std::abs(error) : error;
    ++counted;
  }
  return 1e3 * sum / counted;
}

nlohmann::json Interval(const std::vector<double>& values) {
  const MeanOverTasks mean = MeanWithInterval(values, 1);
  return {{"mean", mean.mean}, {"low95", mean.low95}, {"high95", mean.high95}};
}

nlohmann::json FiguresOf(const std::map<size_t, StrokeFile>& grains, const std::map<size_t, StrokeFile>& model,
                         std::span<const Task> tasks) {
  nlohmann::json rows = nlohmann::json::array();
  std::map<std::string, std::vector<double>> columns;
  for (const auto& [i, played] : grains) {
    if (!model.contains(i)) continue;
    const Task& task = tasks[i];
    const HeightMap &bed = played.strokes.front().before, &end = played.strokes.back().after;
    const HeightMap& model_end = model.at(i).strokes.back().after;
    // A bed at rest is off the shape that it was made for by its roughness alone.
    HeightMap shape = task.terrain;
    shape.mask = task.goal.mask;
    const double rough_mm = ErrorOver_mm(bed, shape, nullptr, nullptr);
    const double model_mm = ErrorOver_mm(model_end, task.goal, nullptr, nullptr);
    const double adds_mm = ErrorOver_mm(model_end, task.goal, &bed, &task.terrain) - model_mm;
    const double grains_mm = ErrorOver_mm(end, task.goal, nullptr, nullptr);
    std::map<std::string, double> row = {
        {"start_grains_mm", ErrorOver_mm(bed, task.goal, nullptr, nullptr)},
        {"start_model_mm", ErrorOver_mm(task.terrain, task.goal, nullptr, nullptr)},
        {"grains_mm", grains_mm},
        {"model_mm", model_mm},
        {"roughness_alone_mm", rough_mm},
        {"roughness_adds_mm", adds_mm},
        {"grains_less_roughness_mm", grains_mm - adds_mm},
        {"too_high_grains_mm", ErrorOver_mm(end, task.goal, nullptr, nullptr, false)},
        {"too_high_model_mm", ErrorOver_mm(model_end, task.goal, nullptr, nullptr, false)}};
    for (const auto& [name, value] : row) columns[name].push_back(value);
    nlohmann::json json = row;
    json["task"] = i;
    json["grains_after_mm"] = json["model_after_mm"] = nlohmann::json::array();
    for (const StrokeRecord& s : played.strokes) json["grains_after_mm"].push_back(1e3 * GoalError(s.after, task.goal));
    for (const StrokeRecord& s : model.at(i).strokes)
      json["model_after_mm"].push_back(1e3 * GoalError(s.after, task.goal));
    rows.push_back(std::move(json));
  }
  nlohmann::json json = {{"tasks", rows.size()}, {"per_task", rows}};
  if (rows.empty()) return json;
  for (const auto& [name, values] : columns) json[name] = Interval(values);
  json["ratio"] = Mean(columns["grains_mm"]) / Mean(columns["model_mm"]);
  json["ratio_less_roughness"] = Mean(columns["grains_less_roughness_mm"]) / Mean(columns["model_mm"]);
  return json;
}

int Run(const fs::path& out, const fs::path& tasks_file, const fs::path& grains, const fs::path& model) {
  const std::vector<Task> tasks = ReadTasks(tasks_file);
  nlohmann::json result = {{"commit", BuildCommit()},
                           {"machine", MachineDescription()},
                           {"tasks_sha256", TasksSha256(tasks)},
                           {"agents", nlohmann::json::object()}};
  for (const auto& entry : fs::directory_iterator(grains)) {
    if (!entry.is_directory()) continue;
    const std::string agent = entry.path().filename().string();
    const auto played = Played(entry.path(), tasks);
    if (played.empty()) continue;
    result["settings"] = nlohmann::json::parse(played.begin()->second.material);
    result["agents"][agent] = FiguresOf(played, Played(model / agent, tasks), tasks);
    const nlohmann::json& row = result["agents"][agent];
    if (!row.contains("ratio")) continue;
    fmt::print("{:12} {} tasks: grains {:.2f}, model {:.2f}, roughness adds {:.2f} (alone {:.2f}): ratio {:.2f}, "
               "less it {:.2f}\n", agent, row["tasks"].get<int>(), row["grains_mm"]["mean"].get<double>(),
               row["model_mm"]["mean"].get<double>(), row["roughness_adds_mm"]["mean"].get<double>(),
               row["roughness_alone_mm"]["mean"].get<double>(), row["ratio"].get<double>(),
               row["ratio_less_roughness"].get<double>());
  }
  // Task by task between agents, in both worlds.
  const auto& agents = result["agents"];
  for (auto a = agents.begin(); a != agents.end(); ++a) {
    for (auto b = std::next(a); b != agents.end(); ++b) {
      std::vector<double> in_grains, in_model;
      for (const auto& of_a : a.value()["per_task"]) {
        for (const auto& of_b : b.value()["per_task"]) {
          if (of_a["task"] != of_b["task"]) continue;
          in_grains.push_back(of_a["grains_mm"].get<double>() - of_b["grains_mm"].get<double>());
          in_model.push_back(of_a["model_mm"].get<double>() - of_b["model_mm"].get<double>());
        }
      }
      if (in_grains.empty()) continue;
      const bool same = (Mean(in_grains) > 0) == (Mean(in_model) > 0);
      result["order"][a.key() + " less " + b.key()] = {
          {"tasks", in_grains.size()}, {"grains_mm", Interval(in_grains)}, {"model_mm", Interval(in_model)},
          {"same_order", same}};
      fmt::print("{} less {}: grains {:+.2f}, model {:+.2f} mm over {} tasks: {}\n", a.key(), b.key(), Mean(in_grains),
                 Mean(in_model), in_grains.size(), same ? "the same order" : "ANOTHER ORDER");
    }
  }
  WriteFileAtomically(out, result.dump(1) + "\n");
  return 0;
}

}  // namespace
}  // namespace sandwright

int main(int count, char** words) {
  if (count != 5) {
    fmt::print(stderr, "usage: grain_agents OUT.json TASKS.h5 GRAINS_FOLDER MODEL_FOLDER\n");
    return 2;
  }
  try {
    return sandwright::Run(words[1], words[2], words[3], words[4]);
  } catch (const std::exception& e) {
    fmt::print(stderr, "error: {}\n", e.what());
    return 1;
  }
}
