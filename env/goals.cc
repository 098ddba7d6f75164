#include "env/goals.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace sandwright {
namespace {

// Distance outward from the edge of the shape's flat top or bottom [m]; negative on it.
double DistanceFromFlat(const GoalShape& shape, double x_m, double y_m) {
  const double dx = x_m - shape.x_m, dy = y_m - shape.y_m;
  if (shape.kind == GoalKind::kMound || shape.kind == GoalKind::kCrater)
    return std::hypot(dx, dy) - shape.half_width_m;
  const double c = std::cos(shape.heading_rad), s = std::sin(shape.heading_rad);
  const double along = std::max(0.0, std::abs(c * dx + s * dy) - shape.half_length_m);
  return std::hypot(along, c * dy - s * dx) - shape.half_width_m;
}

bool WithoutFoot(GoalKind kind) { return kind == GoalKind::kLevel || kind == GoalKind::kTerrace; }

}  // namespace

GoalKind ParseGoalKind(const std::string& name) {
  const auto found = std::ranges::find(kGoalNames, name);
  if (found == kGoalNames.end())
    throw Error(
        fmt::format("goal kind \"{}\" is unknown; allowed: {}", name, fmt::join(kGoalNames, ", ")));
  return static_cast<GoalKind>(found - kGoalNames.begin());
}

double ShapeHeight(const GoalShape& shape, double x_m, double y_m) {
  switch (shape.kind) {
    case GoalKind::kLevel: return 0;
    case GoalKind::kTerrace: {
      const double uphill = std::cos(shape.heading_rad) * (x_m - shape.x_m) +
                            std::sin(shape.heading_rad) * (y_m - shape.y_m);
      return std::clamp(shape.slope * uphill, -shape.rise_m / 2, shape.rise_m / 2);
    }
    default: {
      const double flank = shape.rise_m - shape.slope * DistanceFromFlat(shape, x_m, y_m);
      const double height = std::clamp(flank, 0.0, shape.rise_m);
      const bool up = shape.kind == GoalKind::kMound || shape.kind == GoalKind::kRidge;
      return up ? height : -height;
    }
  }
}

double DistanceToFoot(const GoalShape& shape, double x_m, double y_m) {
  return WithoutFoot(shape.kind) ? -1
                                 : DistanceFromFlat(shape, x_m, y_m) - shape.rise_m / shape.slope;
}

HeightMap MakeGoal(const GoalShape& shape, const HeightMap& terrain, const Region& region,
                   double margin_m) {
  SAND_CHECK(shape.slope > 0 && shape.rise_m >= 0, shape.slope, shape.rise_m);
  HeightMap goal = terrain;
  goal.valid.clear();
  goal.mask.assign(goal.size(), 0);
  bool any = false;
  for (int row = 0; row < goal.rows; ++row) {
    for (int column = 0; column < goal.columns; ++column) {
      const double x = (column + 0.5) * goal.cell_size_m, y = (row + 0.5) * goal.cell_size_m;
      if (x < region.x_m || x > region.x_m + region.width_m || y < region.y_m ||
          y > region.y_m + region.depth_m || DistanceToFoot(shape, x, y) > margin_m)
        continue;
      const size_t i = goal.Index(row, column);
      goal.mask[i] = 1;
      goal.height_m[i] = static_cast<float>(ShapeHeight(shape, x, y));
      any = true;
    }
  }
  if (!any)
    throw Error(fmt::format("the goal's shape at ({:.3f}, {:.3f}) m covers no cell of its place",
                            shape.x_m, shape.y_m));
  return BalanceGoal(goal, terrain, std::string(kGoalNames[static_cast<size_t>(shape.kind)]));
}

HeightMap BalanceGoal(const HeightMap& wish, const HeightMap& terrain, const std::string& name) {
  SAND_CHECK(wish.SameGrid(terrain) && wish.mask.size() == wish.size(), wish.rows, terrain.rows);
  HeightMap goal = terrain;
  goal.valid.clear();
  goal.mask = wish.mask;
  double difference = 0, lowest_m = 0, highest_m = 0;
  size_t count = 0;
  for (size_t i = 0; i < goal.size(); ++i) {
    if (!goal.mask[i]) continue;
    const double height_m = wish.height_m[i];
    lowest_m = count == 0 ? height_m : std::min(lowest_m, height_m);
    highest_m = count == 0 ? height_m : std::max(highest_m, height_m);
    difference += static_cast<double>(terrain.height_m[i]) - height_m;
    ++count;
  }
  SAND_CHECK(count > 0);
  const double plane_m = difference / static_cast<double>(count);
  if (goal.datum == Datum::kFloor && plane_m + lowest_m < 0)
    throw Error(
        fmt::format("the {} goal reaches {:.1f} mm below the floor: {:.1f} mm from its lowest to its "
                    "highest point are too much for the sand there",
                    name, -1e3 * (plane_m + lowest_m), 1e3 * (highest_m - lowest_m)));
  for (size_t i = 0; i < goal.size(); ++i)
    if (goal.mask[i]) goal.height_m[i] = static_cast<float>(plane_m + wish.height_m[i]);
  return goal;
}

}  // namespace sandwright
