#include "env/stroke_window.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace sandwright {
namespace {

// Cells [first, last) of an axis of `count` cells that touch [low, high].
std::pair<int, int> TouchedCells(double low_m, double high_m, int count, double cell_size_m) {
  const double extent_m = count * cell_size_m;
  const auto cell = [&](double x_m) { return std::clamp(x_m, 0.0, extent_m) / cell_size_m; };
  return {static_cast<int>(std::floor(cell(low_m) + 1e-9)),
          static_cast<int>(std::ceil(cell(high_m) - 1e-9))};
}

}  // namespace

CellRect StrokeWindow(const HeightMap& map, const ToolPath& path) {
  SAND_CHECK(!path.empty());
  const auto [x0, x1] = std::ranges::minmax(path, {}, &BladePose::x_m);
  const auto [y0, y1] = std::ranges::minmax(path, {}, &BladePose::y_m);
  const BladePose& end = path.back();
  const double ahead_x_m = end.x_m + kWindowAhead_m * std::cos(end.yaw_rad);
  const double ahead_y_m = end.y_m + kWindowAhead_m * std::sin(end.yaw_rad);
  CellRect rect;
  std::tie(rect.column0, rect.column1) =
      TouchedCells(std::min(x0.x_m - kWindowMargin_m, ahead_x_m),
                   std::max(x1.x_m + kWindowMargin_m, ahead_x_m), map.columns, map.cell_size_m);
  std::tie(rect.row0, rect.row1) =
      TouchedCells(std::min(y0.y_m - kWindowMargin_m, ahead_y_m),
                   std::max(y1.y_m + kWindowMargin_m, ahead_y_m), map.rows, map.cell_size_m);
  return rect.empty() ? CellRect{} : rect;
}

CellRect ChangedBounds(const HeightMap& before, const HeightMap& after, double threshold_m) {
  SAND_CHECK(before.SameGrid(after));
  CellRect bounds;
  for (int row = 0; row < before.rows; ++row) {
    for (int column = 0; column < before.columns; ++column) {
      const double change_m = static_cast<double>(after.At(row, column)) - before.At(row, column);
      if (std::abs(change_m) > threshold_m)
        bounds = Union(bounds, {row, column, row + 1, column + 1});
    }
  }
  return bounds;
}

}  // namespace sandwright
