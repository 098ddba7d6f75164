#include "env/terrain_generator.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "env/avalanche.h"

namespace sandwright {
namespace {

// Adds a lattice of random values, smoothly interpolated, with hills about `size_m` wide.
void AddNoise(double size_m, double amplitude, RandomStream& stream, HeightMap& map) {
  const double shift_x = stream.Uniform(), shift_y = stream.Uniform();
  const int columns = static_cast<int>(map.width_m() / size_m) + 3;
  const int rows = static_cast<int>(map.depth_m() / size_m) + 3;
  std::vector<double> lattice(static_cast<size_t>(rows * columns));
  for (double& value : lattice) value = amplitude * stream.Normal();
  const auto smooth = [](double t) { return t * t * t * (t * (6 * t - 15) + 10); };
  for (int row = 0; row < map.rows; ++row) {
    const double y = (row + 0.5) * map.cell_size_m / size_m + shift_y;
    const int j = static_cast<int>(y);
    const double b = smooth(y - j);
    for (int column = 0; column < map.columns; ++column) {
      const double x = (column + 0.5) * map.cell_size_m / size_m + shift_x;
      const int i = static_cast<int>(x);
      const double a = smooth(x - i);
      const double* corner = &lattice[static_cast<size_t>(j * columns + i)];
      const double value = (1 - b) * ((1 - a) * corner[0] + a * corner[1]) +
                           b * ((1 - a) * corner[columns] + a * corner[columns + 1]);
      map.At(row, column) += static_cast<float>(value);
    }
  }
}

// Shifts and scales the heights to a mean and a standard deviation, none below a fifth of the mean.
void Normalise(double mean_m, double deviation_m, HeightMap& map) {
  const auto count = static_cast<double>(map.size());
  const double mean = std::accumulate(map.height_m.begin(), map.height_m.end(), 0.0) / count;
  double square = 0, lowest = 0;
  for (const float h : map.height_m) {
    square += (h - mean) * (h - mean);
    lowest = std::min(lowest, h - mean);
  }
  double scale = square > 0 ? deviation_m / std::sqrt(square / count) : 0;
  if (-lowest * scale > 0.8 * mean_m) scale = 0.8 * mean_m / -lowest;
  for (float& h : map.height_m) h = static_cast<float>(mean_m + scale * (h - mean));
}

}  // namespace

HeightMap GenerateTerrain(const TerrainConfig& config, int rows, int columns, double cell_size_m,
                          RandomStream& stream) {
  TerrainConfig checked = config;
  const FieldList fields = FieldsOf(checked);
  LoadJson(fields, ToJson(fields), "terrain");
  HeightMap map(rows, columns, cell_size_m);
  CheckHeightMap(map, "generated terrain");
  double size_m = config.longest_m, amplitude = 1;
  for (int64_t scale = 0; scale < config.scales && size_m >= cell_size_m; ++scale) {
    AddNoise(size_m, amplitude, stream, map);
    size_m /= 2;
    amplitude *= config.persistence;
  }
  Normalise(config.mean_depth_m, config.amplitude_m, map);
  RelaxToRepose(map, config.repose_deg);
  return map;
}

}  // namespace sandwright
