// Figures of goals: what sand and blade can make of 20 wishes.
//
//   goal_figures OUT.json [PICTURES_FOLDER]
//
// The wishes lie on one generated bed of 600 x 600 mm on 5 mm cells: shapes by name with slopes that sand holds and steeper
// ones, letters, cones and grooves. `at_rest_error_mm` is from outside the repair: mean |height - goal| over what counts, once the
// goal lies in the bed with the sand around it and everything has come to rest.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "data/base/atomic_file.h"
#include "data/base/machine.h"
#include "data/drawing.h"
#include "data/picture.h"
#include "data/task.h"
#include "env/avalanche.h"
#include "env/feasible_goal.h"
#include "env/goal_picture.h"
#include "env/goal_wish.h"
#include "env/goals.h"
#include "env/terrain_generator.h"

namespace sandwright {
namespace {

constexpr int kCells = 120;
constexpr double kCell_m = 0.005, kMiddle_m = kCells * kCell_m / 2;

struct NamedWish {
  std::string name;
  HeightMap shape;  // heights about the sand's mean, on the bed's grid
};

template <class HeightOf>
NamedWish Drawn(const std::string& name, const HeightOf& height_m) {
  HeightMap shape(kCells, kCells, kCell_m);
  for (int row = 0; row < kCells; ++row)
    for (int column = 0; column < kCells; ++column)
      shape.At(row, column) = static_cast<float>(height_m((column + 0.5) * kCell_m, (row + 0.5) * kCell_m));
  return {name, shape};
}

NamedWish Shape(GoalKind kind, double rise_m, double slope) {
  const GoalShape shape{.kind = kind, .x_m = kMiddle_m, .y_m = kMiddle_m, .heading_rad = 0.6, .half_length_m = 0.1,
                        .half_width_m = 0.04, .rise_m = rise_m, .slope = slope};
  return Drawn(fmt::format("{}, {:g} mm, {:.0f} degrees", kGoalNames[static_cast<size_t>(kind)], 1e3 * rise_m, std::atan(slope) * 180 / M_PI),
               [&](double x_m, double y_m) {
                 return DistanceToFoot(shape, x_m, y_m) > 0.05 ? std::nan("") : ShapeHeight(shape, x_m, y_m);
               });
}

NamedWish Letters(const std::string& text, double range_m, int line_cells) {
  const cv::Mat grey = DrawLetters(text, kCells, kCells, line_cells);
  return Drawn(fmt::format("letters {}, {:g} mm, lines of {:g} mm", text, 1e3 * range_m, 1e3 * line_cells * kCell_m), [&](double x_m, double y_m) {
    return range_m * grey.at<float>(kCells - 1 - static_cast<int>(y_m / kCell_m), static_cast<int>(x_m / kCell_m));
  });
}

NamedWish Cone(double radius_m, double height_m) {
  return Drawn(fmt::format("cone, {:g} mm wide, {:g} mm high", 2e3 * radius_m, 1e3 * height_m), [&](double x_m, double y_m) {
    return height_m * std::max(0.0, 1 - std::hypot(x_m - kMiddle_m, y_m - kMiddle_m) / radius_m);
  });
}

NamedWish Grooves(double width_m, double depth_m) {
  return Drawn(fmt::format("grooves {:g} mm wide, {:g} mm deep", 1e3 * width_m, 1e3 * depth_m), [&](double x_m, double) {
    return std::fmod(x_m, 0.15) < width_m ? -depth_m : 0.0;
  });
}

std::vector<NamedWish> Wishes() {
  std::vector<NamedWish> wishes;
  for (const GoalKind kind : {GoalKind::kLevel, GoalKind::kMound, GoalKind::kCrater, GoalKind::kTrench, GoalKind::kRidge, GoalKind::kTerrace})
    wishes.push_back(Shape(kind, 0.02, 0.45));
  for (const GoalKind kind : {GoalKind::kMound, GoalKind::kCrater, GoalKind::kTrench, GoalKind::kRidge, GoalKind::kTerrace})
    wishes.push_back(Shape(kind, 0.04, 2));
  wishes.push_back(Letters("S", -0.015, 12));
  wishes.push_back(Letters("A", 0.025, 12));
  wishes.push_back(Letters("UR", 0.02, 8));
  wishes.push_back(Letters("SAND", -0.02, 5));
  wishes.push_back(Cone(0.12, 0.06));
  wishes.push_back(Cone(0.2, 0.2));
  wishes.push_back(Cone(0.03, 0.03));
  wishes.push_back(Grooves(0.08, 0.015));
  wishes.push_back(Grooves(0.02, 0.015));
  return wishes;
}

double AtRestError_mm(const HeightMap& goal) {
  HeightMap sand = goal;
  sand.mask.clear();
  for (float& h : sand.height_m) h = std::max(h, 0.0f);
  RelaxToRepose(sand, FeasibilityConfig().repose_deg);
  return 1e3 * GoalError(sand, goal);
}

nlohmann::json Figures(const std::string& pictures) {
  RandomStream stream(1, StreamId("goal figures"));
  const HeightMap terrain = GenerateTerrain({.mean_depth_m = 0.08}, kCells, kCells, kCell_m, stream);
  const FeasibilityConfig config;
  nlohmann::json rows = nlohmann::json::array();
  for (const NamedWish& wish : Wishes()) {
    WishPlace place;
    place.zero_m = MeanCounted(terrain);
    const HeightMap goal = PlaceWish(wish.shape, place, terrain, wish.name).goal;
    const HeightMap feasible = NearestFeasible(goal, terrain, config);
    nlohmann::json row = {{"name", wish.name}, {"wish", ToJson(JudgeGoal(goal, terrain, config, nullptr))},
                          {"feasible", ToJson(JudgeGoal(feasible, terrain, config, nullptr))}, {"mean_change_mm", 1e3 * GoalError(feasible, goal)}};
    row["wish"]["at_rest_error_mm"] = AtRestError_mm(goal);
    row["feasible"]["at_rest_error_mm"] = AtRestError_mm(feasible);
    if (!pictures.empty()) WritePicture(DrawGoals(terrain, goal, feasible), std::filesystem::path(pictures) / fmt::format("{:02}.png", rows.size()));
    rows.push_back(row);
  }
  return rows;
}

}  // namespace
}  // namespace sandwright

int main(int argc, char** argv) {
  if (argc != 2 && argc != 3) {
    fmt::print(stderr, "usage: goal_figures OUT.json [PICTURES_FOLDER]\n");
    return 2;
  }
  const nlohmann::json result = {{"command", fmt::format("goal_figures {}", argv[1])}, {"commit", sandwright::BuildCommit()},
                                 {"machine", sandwright::MachineDescription()}, {"wishes", sandwright::Figures(argc == 3 ? argv[2] : "")}};
  sandwright::WriteFileAtomically(argv[1], result.dump(1) + "\n");
}
