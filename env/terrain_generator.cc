#include "env/terrain_generator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "data/excavation.h"
#include "env/avalanche.h"
#include "env/goals.h"
#include "env/heightfield.h"

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

double Mean(const HeightMap& map) {
  return std::accumulate(map.height_m.begin(), map.height_m.end(), 0.0) /
         static_cast<double>(map.size());
}

// Scales the heights about their mean to a standard deviation.
void ScaleTo(double deviation_m, HeightMap& map) {
  const double mean = Mean(map);
  double square = 0;
  for (const float h : map.height_m) square += (h - mean) * (h - mean);
  const double scale =
      square > 0 ? deviation_m / std::sqrt(square / static_cast<double>(map.size())) : 0;
  for (float& h : map.height_m) h = static_cast<float>(scale * (h - mean));
}

// Shifts the heights to a mean, and scales them where a cell would lie below a fifth of it.
void ShiftTo(double mean_m, HeightMap& map) {
  const double mean = Mean(map);
  const double lowest = *std::ranges::min_element(map.height_m) - mean;
  const double scale = -lowest > 0.8 * mean_m ? 0.8 * mean_m / -lowest : 1;
  for (float& h : map.height_m) h = static_cast<float>(mean_m + scale * (h - mean));
}

void AddShape(double largest_m, RandomStream& stream, HeightMap& map) {
  constexpr std::array kKinds = {GoalKind::kMound, GoalKind::kCrater, GoalKind::kTrench,
                                 GoalKind::kRidge};
  GoalShape shape;
  shape.kind = kKinds[stream.Index(kKinds.size())];
  shape.x_m = stream.Uniform(0, map.width_m());
  shape.y_m = stream.Uniform(0, map.depth_m());
  shape.heading_rad = stream.Uniform(-std::numbers::pi, std::numbers::pi);
  shape.half_length_m = stream.Uniform(0.1, 0.4) * std::min(map.width_m(), map.depth_m());
  shape.half_width_m = stream.Uniform(0, 0.03);
  shape.rise_m = stream.Uniform(0.3, 1) * largest_m;
  shape.slope = stream.Uniform(0.3, 0.6);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column)
      map.At(row, column) += static_cast<float>(
          ShapeHeight(shape, (column + 0.5) * map.cell_size_m, (row + 0.5) * map.cell_size_m));
  }
}

void AddTilt(double largest_deg, RandomStream& stream, HeightMap& map) {
  const double slope = std::tan(stream.Uniform(0, largest_deg) * std::numbers::pi / 180);
  const double azimuth = stream.Uniform(-std::numbers::pi, std::numbers::pi);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column)
      map.At(row, column) += static_cast<float>(
          slope * map.cell_size_m * (column * std::cos(azimuth) + row * std::sin(azimuth)));
  }
}

void Excavate(const TerrainConfig& config, RandomStream& stream, HeightMap& map) {
  HeightfieldConfig sand;
  sand.repose_deg = config.repose_deg;
  sand.loose_deg = std::min(sand.loose_deg, sand.repose_deg);
  const Heightfield heightfield(sand);
  SandState state(std::move(map));
  for (int64_t i = 0; i < config.strokes; ++i) {
    const Stroke stroke = DrawStroke({}, state.map(), stream);
    heightfield.Apply(std::span(&state, 1), std::span(&stroke, 1));
  }
  map = state.map();
  RelaxToRepose(map, config.repose_deg);
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
  ScaleTo(config.amplitude_m, map);
  for (int64_t i = 0; i < config.shapes; ++i) AddShape(config.shape_height_m, stream, map);
  if (config.tilt_deg > 0) AddTilt(config.tilt_deg, stream, map);
  ShiftTo(config.mean_depth_m, map);
  RelaxToRepose(map, config.repose_deg);
  if (config.strokes > 0) Excavate(config, stream, map);
  return map;
}

}  // namespace sandwright
