#include "agents/lane.h"

#include <algorithm>
#include <cmath>

namespace sandwright {
namespace {

constexpr double kStep_m = 0.005;  // at least

}  // namespace

Lane LaneOf(const TaskView& view, const Eigen::Vector2d& start_m, const Eigen::Vector2d& along,
            double length_m, double width_m) {
  const HeightMap &map = view.sensed, &goal = view.goal;
  Lane lane{start_m, along, std::max(kStep_m, map.cell_size_m), {}};
  const Eigen::Vector2d across(-along.y(), along.x());
  const int samples = std::max(1, static_cast<int>(std::round(width_m / lane.step_m)));
  const auto steps = static_cast<size_t>(length_m / lane.step_m + 1e-6);
  for (size_t i = 0; i < steps; ++i) {
    double above_m = 0;
    for (int k = 0; k < samples; ++k) {
      const Eigen::Vector2d p = lane.At(i) + ((k + 0.5) / samples - 0.5) * width_m * across;
      const int row = std::clamp(static_cast<int>(p.y() / map.cell_size_m), 0, map.rows - 1);
      const int column = std::clamp(static_cast<int>(p.x() / map.cell_size_m), 0, map.columns - 1);
      const size_t cell = map.Index(row, column);
      if (goal.mask[cell]) above_m += map.height_m[cell] - goal.height_m[cell];
    }
    lane.above_m.push_back(above_m / samples);
  }
  return lane;
}

std::vector<Pass> PassesOf(const Lane& lane, double longest_m) {
  const auto reach = static_cast<size_t>(longest_m / lane.step_m + 1e-6);
  std::vector<Pass> passes;
  for (size_t first = 0; first < lane.size(); ++first) {
    if (lane.above_m[first] <= 0) continue;
    Pass pass{first, first, 0};
    double load_m2 = 0;
    for (size_t i = first; i < std::min(lane.size(), first + reach + 1); ++i) {
      const double taken_m2 = std::max(lane.above_m[i] * lane.step_m, -load_m2);
      load_m2 += taken_m2;
      if (taken_m2 < 0) pass.last = i, pass.area_m2 -= taken_m2;
    }
    if (pass.area_m2 > 0) passes.push_back(pass);
  }
  return passes;
}

}  // namespace sandwright
