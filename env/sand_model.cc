#include "env/sand_model.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

namespace sandwright {

std::vector<Outcome> SandModel::Apply(std::span<SandState> states,
                                      std::span<const ToolPath> paths) const {
  SAND_CHECK(states.size() == paths.size(), states.size(), paths.size());
  for (size_t i = 0; i < states.size(); ++i) {
    const HeightMap& map = states[i].map();
    CheckHeightMap(map, fmt::format("terrain {}", i));
    if (cell_size_m() && std::abs(*cell_size_m() - map.cell_size_m) > 1e-9)
      throw Error(fmt::format("sand model {} works on cells of {} m; the terrain has {} m", name(),
                              *cell_size_m(), map.cell_size_m));
    if (paths[i].empty()) throw Error(fmt::format("tool path {} is empty", i));
    for (const BladePose& pose : paths[i]) {
      if (!std::isfinite(pose.x_m + pose.y_m + pose.z_m + pose.yaw_rad))
        throw Error(fmt::format("tool path {} holds a pose that is not finite", i));
    }
  }
  return ApplyChecked(states, paths);
}

std::vector<Outcome> SandModel::Apply(std::span<SandState> states,
                                      std::span<const Stroke> strokes) const {
  SAND_CHECK(states.size() == strokes.size(), states.size(), strokes.size());
  std::vector<ToolPath> paths;
  for (size_t i = 0; i < strokes.size(); ++i)
    paths.push_back(SamplePath(strokes[i], states[i].map().cell_size_m / 2));
  return Apply(states, paths);
}

double MovedVolume(const HeightMap& before, const HeightMap& after, const CellRect& rect) {
  double sum = 0;
  for (int row = rect.row0; row < rect.row1; ++row) {
    for (int column = rect.column0; column < rect.column1; ++column)
      sum += std::abs(static_cast<double>(after.At(row, column)) - before.At(row, column));
  }
  return sum / 2 * before.cell_size_m * before.cell_size_m;
}

}  // namespace sandwright
