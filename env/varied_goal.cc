#include "env/varied_goal.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "env/avalanche.h"
#include "env/feasible_goal.h"
#include "env/goal_wish.h"
#include "env/terrain_generator.h"

namespace sandwright {
namespace {

constexpr double kRepose_deg = 33;

HeightMap WithHills(const HeightMap& terrain, const VaryConfig& config, RandomStream& stream) {
  if (config.amplitude_m == 0) return terrain;
  TerrainConfig hills{.mean_depth_m = 1, .amplitude_m = config.amplitude_m, .longest_m = config.hill_m, .scales = 2};
  const HeightMap added = GenerateTerrain(hills, terrain.rows, terrain.columns, terrain.cell_size_m, stream);
  HeightMap varied = terrain;
  varied.valid.clear();
  for (size_t i = 0; i < varied.size(); ++i) {
    const double h = terrain.height_m[i] + added.height_m[i] - hills.mean_depth_m;
    varied.height_m[i] = static_cast<float>(terrain.datum == Datum::kFloor ? std::max(h, 0.0) : h);
  }
  RelaxToRepose(varied, kRepose_deg);
  return varied;
}

// What counts alone, heights about their mean, and the middle of it in the box.
std::pair<HeightMap, Eigen::Vector2d> Relief(const HeightMap& goal) {
  CellRect counted;
  for (int row = 0; row < goal.rows; ++row)
    for (int column = 0; column < goal.columns; ++column)
      if (goal.mask[goal.Index(row, column)]) counted = Union(counted, {row, column, row + 1, column + 1});
  HeightMap relief = Crop(goal, counted);
  const double mean_m = MeanCounted(relief);
  for (size_t i = 0; i < relief.size(); ++i)
    relief.height_m[i] = relief.mask[i] ? static_cast<float>(relief.height_m[i] - mean_m) : std::nanf("");
  const Eigen::Vector2d twice(counted.column0 + counted.column1, counted.row0 + counted.row1);
  return {relief, twice / 2 * goal.cell_size_m};
}

}  // namespace

Task VaryGoal(const HeightMap& terrain, const HeightMap& goal, const VaryConfig& config, int max_strokes,
              RandomStream& stream) {
  if (config.depth_high < config.depth_low)
    throw Error(fmt::format("vary.depth_high = {}; must be at least vary.depth_low = {}", config.depth_high,
                            config.depth_low));
  const auto [relief, middle_m] = Relief(goal);
  WishPlace place;
  const double dx = stream.Uniform(-1, 1), dy = stream.Uniform(-1, 1), turn = stream.Uniform(-1, 1);
  place.at_m = middle_m + config.shift_m * Eigen::Vector2d(dx, dy);
  place.turn_rad = turn * config.turn_deg * std::numbers::pi / 180;
  place.height_scale = stream.Uniform(config.depth_low, config.depth_high);
  Task task{WithHills(terrain, config, stream), {}, max_strokes};
  place.zero_m = MeanCounted(task.terrain);
  const FeasibilityConfig as_drawn{.repose_deg = kRepose_deg, .narrowest_pit_m = 0, .narrowest_crest_m = 0};
  task.goal = NearestFeasible(PlaceWish(relief, place, task.terrain, "the goal").goal, task.terrain, as_drawn);
  return task;
}

}  // namespace sandwright
