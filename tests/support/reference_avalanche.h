// The avalanche's equations in the plainest form, as a second opinion: double precision, explicit steps of
// the whole map, until no face is steeper than repose by more than a share of 1e-4.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "data/height_map.h"

namespace sandwright {

inline HeightMap ReferenceRelax(const HeightMap& map, double tan_angle) {
  const double rise_m = tan_angle * map.cell_size_m;
  std::vector<double> h(map.height_m.begin(), map.height_m.end());
  const auto at = [&](int row, int column) {
    return h[map.Index(std::clamp(row, 0, map.rows - 1), std::clamp(column, 0, map.columns - 1))];
  };
  for (double steepest = 2; steepest > 1 + 1e-4;) {
    steepest = 0;
    std::vector<double> change(h.size(), 0);
    const auto face = [&](int row, int column, int dr, int dc) {
      const auto across = [&](int r, int c) { return at(r + dc, c + dr) - at(r - dc, c - dr); };
      const double along = at(row + dr, column + dc) - at(row, column);
      const double slope =
          std::hypot(along, (across(row, column) + across(row + dr, column + dc)) / 4);
      steepest = std::max(steepest, std::abs(along) > 0.05 * rise_m ? slope / rise_m : 0);
      const double flux = slope > rise_m ? 0.2 * along * (1 - rise_m / slope) : 0;
      change[map.Index(row, column)] += flux;
      change[map.Index(row + dr, column + dc)] -= flux;
    };
    for (int row = 0; row < map.rows; ++row) {
      for (int column = 0; column < map.columns; ++column) {
        if (column + 1 < map.columns) face(row, column, 0, 1);
        if (row + 1 < map.rows) face(row, column, 1, 0);
      }
    }
    for (size_t i = 0; i < h.size(); ++i) h[i] += change[i];
  }
  HeightMap relaxed = map;
  std::ranges::transform(h, relaxed.height_m.begin(),
                         [](double v) { return static_cast<float>(v); });
  return relaxed;
}

}  // namespace sandwright
