#include "robot_model/reach_map.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <numbers>

#include "data/base/error.h"
#include "robot_model/safety_gate.h"

namespace sandwright {
namespace {

constexpr double kCell_m = 0.025, kStroke_m = 0.04;
constexpr float kSandDepth_m = 0.05f;
constexpr int kHeadings = 8;

HeightMap LevelSand(const BoxSettings& box) {
  for (const double cell : {0.01, 0.005, 0.002, 0.001}) {
    const double columns = box.width_m / cell, rows = box.depth_m / cell;
    if (std::abs(columns - std::round(columns)) > 1e-6 || std::abs(rows - std::round(rows)) > 1e-6)
      continue;
    return HeightMap(static_cast<int>(std::lround(rows)), static_cast<int>(std::lround(columns)),
                     cell, kSandDepth_m);
  }
  throw Error(fmt::format("box of {} x {} m; a reach map needs whole millimetres", box.width_m,
                          box.depth_m));
}

Stroke LineFrom(double x_m, double y_m, double heading_rad) {
  Stroke stroke;
  stroke.control_points_m = {{x_m, y_m, kSandDepth_m},
                             {x_m + kStroke_m * std::cos(heading_rad),
                              y_m + kStroke_m * std::sin(heading_rad), kSandDepth_m}};
  return stroke;
}

}  // namespace

float ReachMap::At(double x_m, double y_m) const {
  if (x_m < 0 || x_m >= width_m || y_m < 0 || y_m >= depth_m) return 0;
  const int column = std::min(columns - 1, static_cast<int>(x_m / width_m * columns));
  const int row = std::min(rows - 1, static_cast<int>(y_m / depth_m * rows));
  return share[static_cast<size_t>(row * columns + column)];
}

ReachMap MeasureReach(const SafetyGate& gate) {
  const BoxSettings& box = gate.workcell().box;
  const HeightMap sand = LevelSand(box);
  ReachMap reach{.rows = static_cast<int>(std::ceil(box.depth_m / kCell_m - 1e-9)),
                 .columns = static_cast<int>(std::ceil(box.width_m / kCell_m - 1e-9)),
                 .width_m = box.width_m,
                 .depth_m = box.depth_m,
                 .share = {}};
  for (int row = 0; row < reach.rows; ++row) {
    for (int column = 0; column < reach.columns; ++column) {
      int accepted = 0;
      for (int h = 0; h < kHeadings; ++h) {
        const Stroke line = LineFrom((column + 0.5) * box.width_m / reach.columns,
                                     (row + 0.5) * box.depth_m / reach.rows,
                                     2 * std::numbers::pi * h / kHeadings);
        accepted += gate.Check(line, sand, GateSampling::kCoarse).accepted;
      }
      reach.share.push_back(static_cast<float>(accepted) / kHeadings);
    }
  }
  return reach;
}

}  // namespace sandwright
