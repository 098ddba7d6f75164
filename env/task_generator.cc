#include "env/task_generator.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace sandwright {
namespace {

constexpr int kDraws = 50;

double MeanHeight(const HeightMap& map) {
  return std::accumulate(map.height_m.begin(), map.height_m.end(), 0.0) /
         static_cast<double>(map.size());
}

// A place of the configured extent on whole cells, anywhere in the box.
Region DrawPlace(const TaskConfig& config, const HeightMap& terrain, RandomStream& stream) {
  const auto axis = [&](double extent_m, int cells, const char* key) {
    const int size = extent_m == 0 ? cells : WholeCells(extent_m, terrain.cell_size_m, key);
    if (size < 2 || size > cells)
      throw Error(fmt::format("{} = {} m; allowed: 0 or {} to {} m, the box", key, extent_m,
                              2 * terrain.cell_size_m, cells * terrain.cell_size_m));
    const auto first = stream.Index(static_cast<uint64_t>(cells - size + 1));
    return std::pair(static_cast<double>(first) * terrain.cell_size_m, size * terrain.cell_size_m);
  };
  const auto [x, width] = axis(config.goal_width_m, terrain.columns, "goal_width_m");
  const auto [y, depth] = axis(config.goal_depth_m, terrain.rows, "goal_depth_m");
  return {x, y, width, depth};
}

GoalShape DrawShape(const TaskConfig& config, const Region& place, double sand_depth_m,
                    RandomStream& stream) {
  if (config.goals.empty()) throw Error("goals is empty; name at least one kind");
  const double extent = std::min(place.width_m, place.depth_m);
  GoalShape shape;
  shape.kind = ParseGoalKind(config.goals[stream.Index(config.goals.size())]);
  shape.x_m = place.x_m + place.width_m * stream.Uniform(0.3, 0.7);
  shape.y_m = place.y_m + place.depth_m * stream.Uniform(0.3, 0.7);
  shape.heading_rad = std::numbers::pi * stream.Uniform(-1, 1);
  shape.half_length_m = extent * stream.Uniform(0.15, 0.35);
  shape.half_width_m = extent * stream.Uniform(0.03, 0.15);
  shape.slope = stream.Uniform(0.3, 0.5);  // 17 to 27 degrees, within the repose of dry sand
  // Its flank no longer than a fifth of its place, its bottom well above the floor.
  const double highest = std::min({0.6 * sand_depth_m, 0.2 * extent * shape.slope, 0.04});
  shape.rise_m = highest * stream.Uniform(0.4, 1);
  return shape;
}

void Flatten(HeightMap& map, double about_m, double factor) {
  for (float& h : map.height_m) h = static_cast<float>(about_m + factor * (h - about_m));
}

}  // namespace

Task GenerateGoal(const TaskConfig& config, const HeightMap& terrain, RandomStream& stream) {
  const Region place = DrawPlace(config, terrain, stream);
  const GoalShape shape = DrawShape(config, place, MeanHeight(terrain), stream);
  const double margin_m =
      config.margin_m == 0 ? std::max(terrain.width_m(), terrain.depth_m()) * 2 : config.margin_m;
  return {terrain, MakeGoal(shape, terrain, place, margin_m), static_cast<int>(config.max_strokes)};
}

Task GenerateTask(const TaskConfig& config, RandomStream& stream) {
  if (config.difficulty_high_m < config.difficulty_low_m)
    throw Error(fmt::format("difficulty_high_m = {}; must be at least difficulty_low_m = {}",
                            config.difficulty_high_m, config.difficulty_low_m));
  const int rows = WholeCells(config.depth_m, config.cell_size_m, "depth_m");
  const int columns = WholeCells(config.width_m, config.cell_size_m, "width_m");
  double roughest_m = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const HeightMap terrain =
        GenerateTerrain(config.terrain, rows, columns, config.cell_size_m, stream);
    Task task = GenerateGoal(config, terrain, stream);
    const double error_m = GoalError(task.terrain, task.goal);
    roughest_m = std::max(roughest_m, error_m);
    if (error_m < config.difficulty_low_m) continue;
    const double wanted_m =
        stream.Uniform(config.difficulty_low_m, std::min(config.difficulty_high_m, error_m));
    const double mean_m = MeanHeight(terrain);
    Flatten(task.terrain, mean_m, wanted_m / error_m);
    Flatten(task.goal, mean_m, wanted_m / error_m);
    return task;
  }
  throw Error(
      fmt::format("no task of difficulty_low_m = {} or more in {} draws (the roughest: {:.4f} m); "
                  "lower it, or make terrain or goals rougher",
                  config.difficulty_low_m, kDraws, roughest_m));
}

}  // namespace sandwright
