#include "env/cell_action.h"

#include <spdlog/fmt/fmt.h>

#include "env/observation.h"

namespace sandwright {
namespace {

// Level k of `count` between -1 and 1, both included.
float Level(int64_t k, int64_t count) {
  return static_cast<float>(2.0 * static_cast<double>(k) / static_cast<double>(count - 1) - 1);
}

// Middle of part k of `count` equal parts of 0..1.
double Middle(int64_t k, int64_t count) {
  return (static_cast<double>(k) + 0.5) / static_cast<double>(count);
}

}  // namespace

CellAction CellActionSizes(const CellActionConfig& config) {
  return {config.rows * config.columns, config.headings, config.lengths,
          config.depths,                config.depths,   config.bends};
}

Action ActionOf(const CellAction& choice, const CellActionConfig& config) {
  const CellAction sizes = CellActionSizes(config);
  for (size_t i = 0; i < choice.size(); ++i) {
    if (choice[i] < 0 || choice[i] >= sizes[i])
      throw Error(fmt::format("choice[{}] = {}; allowed: 0 to {}", i, choice[i], sizes[i] - 1));
  }
  const auto [cell, heading, length, depth_start, depth_end, bend] = choice;
  // The heading's range is -pi to pi, its first level 0.
  const double turn = static_cast<double>(heading) / static_cast<double>(config.headings);
  return {static_cast<float>(2 * Middle(cell % config.columns, config.columns) - 1),
          static_cast<float>(2 * Middle(cell / config.columns, config.rows) - 1),
          static_cast<float>(turn < 0.5 ? 2 * turn : 2 * turn - 2),
          Level(length, config.lengths),
          Level(depth_start, config.depths),
          Level(depth_end, config.depths),
          Level(bend, config.bends)};
}

std::vector<uint8_t> StartMask(const TaskView& view, const CellActionConfig& config) {
  std::vector<uint8_t> mask;
  for (int64_t row = 0; row < config.rows; ++row) {
    for (int64_t column = 0; column < config.columns; ++column) {
      const double x = view.region.x_m + Middle(column, config.columns) * view.region.width_m;
      const double y = view.region.y_m + Middle(row, config.rows) * view.region.depth_m;
      mask.push_back(ReachAt(view, x, y) > 0);
    }
  }
  return mask;
}

}  // namespace sandwright
