#include "env/coarse_heightfield.h"

#include <algorithm>
#include <cmath>

#include "env/surrogate_paste.h"

namespace sandwright {
namespace {

HeightMap Coarsen(const HeightMap& map, int factor) {
  HeightMap coarse((map.rows + factor - 1) / factor, (map.columns + factor - 1) / factor,
                   map.cell_size_m * factor, 0, map.datum);
  for (int row = 0; row < coarse.rows; ++row) {
    for (int column = 0; column < coarse.columns; ++column) {
      double sum_m = 0;
      int count = 0;
      for (int j = row * factor; j < std::min((row + 1) * factor, map.rows); ++j) {
        for (int i = column * factor; i < std::min((column + 1) * factor, map.columns); ++i)
          sum_m += map.At(j, i), ++count;
      }
      coarse.At(row, column) = static_cast<float>(sum_m / count);
    }
  }
  return coarse;
}

// The two large cells around the middle of a small one, and the weight of the second.
struct Neighbours {
  int first, second;
  double weight;
};

Neighbours Around(int cell, int factor, int count) {
  const double at = std::clamp((cell + 0.5) / factor - 0.5, 0.0, count - 1.0);
  const int first = static_cast<int>(at);
  return {first, std::min(first + 1, count - 1), at - first};
}

// The small cells whose interpolated change may differ from zero.
CellRect Refine(const CellRect& changed, int factor, const HeightMap& map) {
  const int rim = factor / 2 + 1;
  return {std::max(changed.row0 * factor - rim, 0), std::max(changed.column0 * factor - rim, 0),
          std::min(changed.row1 * factor + rim, map.rows),
          std::min(changed.column1 * factor + rim, map.columns)};
}

std::vector<double> Interpolate(const HeightMap& before, const HeightMap& after,
                                const CellRect& rect, int factor) {
  std::vector<double> change_m;
  change_m.reserve(static_cast<size_t>(rect.rows()) * static_cast<size_t>(rect.columns()));
  for (int row = rect.row0; row < rect.row1; ++row) {
    const Neighbours y = Around(row, factor, before.rows);
    for (int column = rect.column0; column < rect.column1; ++column) {
      const Neighbours x = Around(column, factor, before.columns);
      const auto change = [&](int r, int c) {
        return static_cast<double>(after.At(r, c)) - before.At(r, c);
      };
      const auto along_x = [&](int r) {
        return change(r, x.first) * (1 - x.weight) + change(r, x.second) * x.weight;
      };
      change_m.push_back(along_x(y.first) * (1 - y.weight) + along_x(y.second) * y.weight);
    }
  }
  return change_m;
}

}  // namespace

Outcome ApplyOnCoarseCells(const Heightfield& heightfield, int factor, SandState& state,
                           const ToolPath& path) {
  if (factor == 1) return heightfield.Apply(std::span(&state, 1), std::span(&path, 1)).front();
  const SandState before(Coarsen(state.map(), factor));
  SandState after = before;
  Outcome outcome = heightfield.Apply(std::span(&after, 1), std::span(&path, 1)).front();
  if (outcome.changed.empty()) return outcome;
  HeightMap map = state.map();
  outcome.changed = Refine(outcome.changed, factor, map);
  AddResidual(outcome.changed, Interpolate(before.map(), after.map(), outcome.changed, factor),
              true, map);
  outcome.moved_volume_m3 = MovedVolume(state.map(), map, outcome.changed);
  state.Replace(std::move(map));
  return outcome;
}

}  // namespace sandwright
