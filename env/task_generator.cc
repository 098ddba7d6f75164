#include "env/task_generator.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "data/drawing.h"

namespace sandwright {
namespace {

constexpr int kDraws = 50;

double MeanHeight(const HeightMap& map) {
  return std::accumulate(map.height_m.begin(), map.height_m.end(), 0.0) /
         static_cast<double>(map.size());
}

constexpr std::string_view kLetters = "letters";  // drawn, so no shape of env/goals.h

// Takes no draw where the range is one number.
double DrawFrom(double low, double high, RandomStream& stream) {
  return low == high ? low : stream.Uniform(low, high);
}

// How deep the sand is; as deep as one likes where the floor is not known.
double SandDepth(const HeightMap& terrain) {
  return terrain.datum == Datum::kFloor ? MeanHeight(terrain)
                                        : std::numeric_limits<double>::infinity();
}

struct PlaceCells {
  int columns, rows;
};

// Of a place of the configured extent, its sides times `side`.
PlaceCells CellsOfPlace(const TaskConfig& config, const HeightMap& terrain, double side) {
  const auto axis = [&](double extent_m, int cells, const char* key) {
    const int size = extent_m == 0 ? cells : WholeCells(extent_m, terrain.cell_size_m, key);
    if (size < 2 || size > cells)
      throw Error(fmt::format("{} = {} m; allowed: 0 or {} to {} m, the box", key, extent_m,
                              2 * terrain.cell_size_m, cells * terrain.cell_size_m));
    return std::max(2, static_cast<int>(std::lround(side * size)));
  };
  return {axis(config.goal_width_m, terrain.columns, "goal_width_m"),
          axis(config.goal_depth_m, terrain.rows, "goal_depth_m")};
}

// A place of the configured extent and share on whole cells, anywhere in the box.
Region DrawPlace(const TaskConfig& config, const HeightMap& terrain, RandomStream& stream) {
  if (config.area_high < config.area_low)
    throw Error(fmt::format("area_high = {}; must be at least area_low = {}", config.area_high,
                            config.area_low));
  const double side = std::sqrt(DrawFrom(config.area_low, config.area_high, stream));
  const auto [columns, rows] = CellsOfPlace(config, terrain, side);
  const auto first_m = [&](int size, int cells) {
    return static_cast<double>(stream.Index(static_cast<uint64_t>(cells - size + 1))) * terrain.cell_size_m;
  };
  const double x_m = first_m(columns, terrain.columns), y_m = first_m(rows, terrain.rows);
  return {x_m, y_m, columns * terrain.cell_size_m, rows * terrain.cell_size_m};
}

const std::string& DrawKind(const TaskConfig& config, RandomStream& stream) {
  if (config.goals.empty()) throw Error("goals is empty; name at least one kind");
  for (const std::string& kind : config.goals) {
    if (kind != kLetters && std::ranges::find(kGoalNames, kind) == kGoalNames.end())
      throw Error(fmt::format("goal kind \"{}\" is unknown; allowed: {}, {}", kind,
                              fmt::join(kGoalNames, ", "), kLetters));
  }
  return config.goals[stream.Index(config.goals.size())];
}

GoalShape DrawShape(const std::string& kind, const Region& place, double sand_depth_m,
                    RandomStream& stream) {
  const double extent = std::min(place.width_m, place.depth_m);
  GoalShape shape;
  shape.kind = ParseGoalKind(kind);
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

// One letter, or as many as have room for their lines, raised or sunk.
HeightMap DrawLettersGoal(const TaskConfig& config, const HeightMap& terrain, const Region& place,
                          RandomStream& stream) {
  constexpr double kLetterLines = 7;  // width of a letter in widths of its lines, with its gap
  const double pixel_m = config.narrowest_m / kNarrowestPixels;
  const double fitting = place.width_m / (kLetterLines * config.narrowest_m);
  const auto most = static_cast<uint64_t>(std::max(1.0, fitting));
  std::string text(1 + stream.Index(most), ' ');
  // Without M and W, whose four lines close up in a small place.
  constexpr std::string_view kAlphabet = "ABCDEFGHIJKLNOPQRSTUVXYZ";
  for (char& letter : text) letter = kAlphabet[stream.Index(kAlphabet.size())];
  const cv::Mat grey =
      DrawLetters(text, static_cast<int>(std::lround(place.depth_m / pixel_m)),
                  static_cast<int>(std::lround(place.width_m / pixel_m)), kNarrowestPixels);
  const bool raised = stream.Index(2) == 1;
  const double slope = stream.Uniform(0.3, 0.5);  // as of shapes
  // No higher than a line of that width still has a flat top.
  const double highest = std::min({0.6 * SandDepth(terrain), slope * config.narrowest_m, 0.04});
  const double range_m = highest * stream.Uniform(0.6, 1);
  return MakeDrawnGoal(grey, raised ? range_m : -range_m, terrain, place, config.narrowest_m, slope);
}

// Throws Error where a letter may be asked for in a place that it does not fit into.
void CheckLettersFit(const TaskConfig& config, const HeightMap& terrain) {
  constexpr double kLines = 10.0 / 3;  // side of the least place that any letter fits into, in widths of its lines
  if (std::ranges::find(config.goals, kLetters) == config.goals.end()) return;
  const auto [columns, rows] = CellsOfPlace(config, terrain, std::sqrt(config.area_low));
  const double least_m = std::min(columns, rows) * terrain.cell_size_m;
  const double widest_m = least_m / kLines;
  if (config.narrowest_m <= widest_m + 1e-9) return;
  throw Error(fmt::format("narrowest_m = {}: letters of such lines do not fit into the least places, of {:.3f} m "
                          "(area_low = {}); allowed there: up to {:.3f} m, or goals without letters",
                          config.narrowest_m, least_m, config.area_low, widest_m));
}

void Flatten(HeightMap& map, double about_m, double factor) {
  for (float& h : map.height_m) h = static_cast<float>(about_m + factor * (h - about_m));
}

}  // namespace

HeightMap DrawTerrain(const TaskConfig& config, RandomStream& stream) {
  return GenerateTerrain(config.terrain, WholeCells(config.depth_m, config.cell_size_m, "depth_m"),
                         WholeCells(config.width_m, config.cell_size_m, "width_m"),
                         config.cell_size_m, stream);
}

Task GenerateGoal(const TaskConfig& config, const HeightMap& terrain, RandomStream& stream) {
  CheckLettersFit(config, terrain);
  const Region place = DrawPlace(config, terrain, stream);
  const std::string& kind = DrawKind(config, stream);
  const int budget = static_cast<int>(config.max_strokes);
  if (kind == kLetters) return {terrain, DrawLettersGoal(config, terrain, place, stream), budget};
  const GoalShape shape = DrawShape(kind, place, SandDepth(terrain), stream);
  const bool near = config.margin_m > 0 &&
                    (config.margin_share == 1 || stream.Uniform() < config.margin_share);
  const double margin_m =
      near ? config.margin_m : std::max(terrain.width_m(), terrain.depth_m()) * 2;
  return {terrain, MakeGoal(shape, terrain, place, margin_m), budget};
}

Task GenerateDrawnGoal(const TaskConfig& config, const cv::Mat& grey, double range_m,
                       const HeightMap& terrain, RandomStream& stream) {
  constexpr double kSlope = GoalShape{}.slope;
  const Region place = DrawPlace(config, terrain, stream);
  return {terrain,
          MakeDrawnGoal(grey, range_m, terrain, place, config.narrowest_m, kSlope),
          static_cast<int>(config.max_strokes)};
}

Task GenerateTask(const TaskConfig& config, RandomStream& stream) {
  if (config.difficulty_high_m < config.difficulty_low_m)
    throw Error(fmt::format("difficulty_high_m = {}; must be at least difficulty_low_m = {}",
                            config.difficulty_high_m, config.difficulty_low_m));
  double roughest_m = 0;
  for (int draw = 0; draw < kDraws; ++draw) {
    const HeightMap terrain = DrawTerrain(config, stream);
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
