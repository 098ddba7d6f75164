#include "cli/task_request.h"

#include <spdlog/fmt/fmt.h>

#include "data/base/parallel.h"

namespace sandwright {
namespace {

std::vector<HeightMap> ReadTerrains(const std::vector<std::string>& files) {
  std::vector<HeightMap> terrains;
  for (const std::string& file : files) {
    terrains.push_back(ReadHeightMap(file));
    if (terrains.back().cell_size_m != terrains[0].cell_size_m)
      throw Error(fmt::format("{}: cell_size_m = {}; {} has {}, and a task file holds one size", file,
                              terrains.back().cell_size_m, files[0], terrains[0].cell_size_m));
  }
  return terrains;
}

}  // namespace

std::vector<Task> MakeTasks(const TaskRequest& request, const TaskConfig& config, uint64_t seed,
                            int threads) {
  const bool drawn = !request.drawing.empty();
  if (!request.generate && request.terrain_files.empty())
    throw Error("tasks needs --terrain FILE..., --generate or --set NAME");
  if (!request.generate && request.goal_file.empty() && !request.random_goals && !drawn)
    throw Error("--terrain needs --goal FILE, --goals KIND,... or --goal-image FILE");
  const int given = request.generate ? 10 : static_cast<int>(request.terrain_files.size());
  const int count = request.count > 0 ? request.count : given;
  if (!request.goal_file.empty() && count > given && !request.vary)
    throw Error(fmt::format("--count {} with one --goal would repeat tasks; at most {}, the terrains; or --vary",
                            count, given));
  const std::vector<HeightMap> terrains = ReadTerrains(request.terrain_files);
  const HeightMap goal = request.goal_file.empty() ? HeightMap() : ReadGoal(request.goal_file);
  const auto task_on = [&](const HeightMap& terrain, RandomStream& stream) -> Task {
    if (drawn) return GenerateDrawnGoal(config, request.drawing, request.range_m, terrain, stream);
    if (request.vary) return VaryGoal(terrain, goal, request.variation, static_cast<int>(config.max_strokes), stream);
    if (request.random_goals) return GenerateGoal(config, terrain, stream);
    return {terrain, goal, static_cast<int>(config.max_strokes)};
  };
  std::vector<Task> tasks(static_cast<size_t>(count));
  ParallelFor(count, threads, [&](int i) {
    const auto n = static_cast<size_t>(i);
    RandomStream stream(seed, kEvaluationTasks, n);
    if (!request.generate) {
      tasks[n] = task_on(terrains[n % terrains.size()], stream);
      CheckTask(tasks[n], request.terrain_files[n % terrains.size()] + " and its goal");
    } else if (drawn) {
      tasks[n] = task_on(DrawTerrain(config, stream), stream);
    } else {
      tasks[n] = GenerateTask(config, stream);
    }
  });
  return tasks;
}

}  // namespace sandwright
