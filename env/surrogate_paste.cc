#include "env/surrogate_paste.h"

#include <algorithm>
#include <cmath>

namespace sandwright {

void AddResidual(const CellRect& rect, std::vector<double> residual_m, bool conserve_volume,
                 HeightMap& map) {
  SAND_CHECK(residual_m.size() ==
             static_cast<size_t>(rect.rows()) * static_cast<size_t>(rect.columns()));
  const auto for_each = [&](const auto& body) {
    size_t i = 0;
    for (int row = rect.row0; row < rect.row1; ++row) {
      for (int column = rect.column0; column < rect.column1; ++column, ++i)
        body(residual_m[i], map.At(row, column));
    }
  };
  const bool floor_known = map.datum == Datum::kFloor;
  double inflow = 0, outflow = 0;
  for_each([&](double& residual, float height) {
    if (floor_known) residual = std::max(residual, -std::max(static_cast<double>(height), 0.0));
    (residual > 0 ? inflow : outflow) += std::abs(residual);
  });
  const double kept = std::min(inflow, outflow);
  for_each([&](double residual, float& height) {
    if (conserve_volume && residual != 0) residual *= kept / (residual > 0 ? inflow : outflow);
    height = static_cast<float>(height + residual);
  });
}

void AddFluxes(const CellRect& rect, std::span<const double> flux_m, HeightMap& map) {
  const int rows = rect.rows(), columns = rect.columns();
  const auto cells = static_cast<size_t>(rows) * static_cast<size_t>(columns);
  SAND_CHECK(flux_m.size() == 2 * cells);
  const auto at = [&](int row, int column) { return static_cast<size_t>(row * columns + column); };
  // Calls body(flux, from, to) for every open face; cells are counted inside `rect`.
  const auto for_each_face = [&](const auto& body) {
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const size_t here = at(row, column);
        const auto face = [&](double flux, size_t there) {
          flux > 0 ? body(flux, here, there) : body(-flux, there, here);
        };
        if (column + 1 < columns) face(flux_m[here], at(row, column + 1));
        if (row + 1 < rows) face(flux_m[cells + here], at(row + 1, column));
      }
    }
  };
  std::vector<double> outflow_m(cells, 0.0), share(cells, 1.0), change_m(cells, 0.0);
  for_each_face([&](double flux, size_t from, size_t) { outflow_m[from] += flux; });
  const auto height = [&](size_t cell) -> float& {
    return map.At(rect.row0 + static_cast<int>(cell) / columns,
                  rect.column0 + static_cast<int>(cell) % columns);
  };
  const bool floor_known = map.datum == Datum::kFloor;
  for (size_t i = 0; i < cells && floor_known; ++i) {
    const double given_m = std::max(static_cast<double>(height(i)), 0.0);
    if (outflow_m[i] > given_m) share[i] = given_m / outflow_m[i];
  }
  for_each_face([&](double flux, size_t from, size_t to) {
    change_m[from] -= flux * share[from];
    change_m[to] += flux * share[from];
  });
  for (size_t i = 0; i < cells; ++i) {
    const auto result_m = static_cast<float>(height(i) + change_m[i]);
    // A cell that gives all may end below the floor by rounding.
    height(i) = floor_known && height(i) >= 0 ? std::max(result_m, 0.0f) : result_m;
  }
}

}  // namespace sandwright
