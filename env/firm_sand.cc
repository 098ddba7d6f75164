#include "env/firm_sand.h"

#include <algorithm>

#include "env/avalanche_kernel.h"

namespace sandwright {

FirmSand::FirmSand(const HeightMap& before, double firmness)
    : before_(before),
      firmness_(firmness),
      loose_(before.size() + kLanes + 1, 0),  // the last cells have next ones
      slope_x_(std::make_unique_for_overwrite<float[]>(before.size() + kLanes)),
      slope_y_(std::make_unique_for_overwrite<float[]>(before.size() + kLanes)) {}

void FirmSand::FindSlopes(const CellRect& rect) {
  for (int row = rect.row0; row < rect.row1; ++row) {
    const auto line = [&](int r) {
      return &before_.height_m[before_.Index(std::clamp(r, 0, before_.rows - 1), 0)];
    };
    const size_t first = before_.Index(row, 0);
    RowSlopes(line(row - 1), line(row), line(row + 1), before_.columns,
              {rect.column0, rect.column1}, &slope_x_[first], &slope_y_[first]);
  }
}

void FirmSand::Resist(const CellRect& window, double rise_m, int stride,
                      std::vector<float>& resist_x, std::vector<float>& resist_y) {
  const CellRect old = known_;
  known_ = Union(known_, window);
  if (old.empty()) {
    FindSlopes(known_);
  } else {
    FindSlopes({known_.row0, known_.column0, old.row0, known_.column1});
    FindSlopes({old.row1, known_.column0, known_.row1, known_.column1});
    FindSlopes({old.row0, known_.column0, old.row1, old.column0});
    FindSlopes({old.row0, old.column1, old.row1, known_.column1});
  }
  for (int row = window.row0; row < window.row1; ++row) {
    const size_t from = before_.Index(row, window.column0);
    const size_t above = before_.Index(std::min(row + 1, before_.rows - 1), window.column0);
    const auto to = static_cast<size_t>((row - window.row0 + 1) * stride + 1);
    RowResistance(&slope_x_[from], &slope_y_[from], &loose_[from], &loose_[above], window.columns(),
                  static_cast<float>(firmness_), static_cast<float>(rise_m), &resist_x[to],
                  &resist_y[to]);
  }
}

}  // namespace sandwright
