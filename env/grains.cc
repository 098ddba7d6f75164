#include "env/grains.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace sandwright {
namespace {

// One pass of a Gaussian along rows or columns, repeating the cells at the walls.
void Blur(double sigma_cells, bool along_rows, HeightMap& map) {
  const int reach = static_cast<int>(std::ceil(4 * sigma_cells));
  std::vector<double> weights;
  double sum = 0;
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(std::exp(-k * k / (2 * sigma_cells * sigma_cells)));
    sum += weights.back();
  }
  const HeightMap source = map;
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      double value = 0;
      for (int k = -reach; k <= reach; ++k) {
        const int r = along_rows ? row : std::clamp(row + k, 0, map.rows - 1);
        const int c = along_rows ? std::clamp(column + k, 0, map.columns - 1) : column;
        value += weights[static_cast<size_t>(k + reach)] * source.At(r, c);
      }
      map.At(row, column) = static_cast<float>(value / sum);
    }
  }
}

}  // namespace

HeightMap SurfaceOf(const GrainBed& bed, int rows, int columns, double blur_m) {
  const double cell = bed.width_m / columns;
  HeightMap map(rows, columns, cell);
  const auto first = [cell](double low) {
    return std::max(0, static_cast<int>(std::ceil(low / cell - 0.5)));
  };
  const auto last = [cell](double high, int count) {
    return std::min(count - 1, static_cast<int>(std::floor(high / cell - 0.5)));
  };
  for (const Grain& g : bed.grains) {
    for (int row = first(g.y_m - g.radius_m); row <= last(g.y_m + g.radius_m, rows); ++row) {
      const double dy = (row + 0.5) * cell - g.y_m;
      for (int column = first(g.x_m - g.radius_m); column <= last(g.x_m + g.radius_m, columns);
           ++column) {
        const double dx = (column + 0.5) * cell - g.x_m;
        const double rise2 = g.radius_m * g.radius_m - dx * dx - dy * dy;
        if (rise2 <= 0) continue;
        float& height = map.At(row, column);
        height = std::max(height, static_cast<float>(g.z_m + std::sqrt(rise2)));
      }
    }
  }
  if (blur_m > 0) {
    Blur(blur_m / cell, true, map);
    Blur(blur_m / cell, false, map);
  }
  return map;
}

std::vector<Grain> ReadGrains(const H5::H5File& file, const std::string& where) {
  const auto array = ReadArray<double>(file, "grains_m", where);
  if (array.columns != 4)
    throw Error(fmt::format("{}: grains_m has {} columns; expected 4", where, array.columns));
  std::vector<Grain> grains;
  for (size_t i = 0; i < array.rows; ++i) {
    const double* g = &array.values[4 * i];
    grains.push_back({g[0], g[1], g[2], g[3]});
  }
  return grains;
}

void WriteGrains(const std::vector<Grain>& grains, H5::H5File& file) {
  static_assert(sizeof(Grain) == 4 * sizeof(double));
  WriteArray(file, "grains_m", &grains.front().x_m, grains.size(), 4);
}

}  // namespace sandwright
