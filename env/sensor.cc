#include "env/sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/gridding.h"

namespace sandwright {
namespace {

HeightMap Shift(const HeightMap& sand, double registration_m, RandomStream& stream) {
  const double dx = registration_m * stream.Normal(), dy = registration_m * stream.Normal();
  HeightMap seen = sand;
  for (int row = 0; row < sand.rows; ++row) {
    for (int column = 0; column < sand.columns; ++column)
      seen.At(row, column) = static_cast<float>(HeightAt(
          sand, (column + 0.5) * sand.cell_size_m + dx, (row + 0.5) * sand.cell_size_m + dy));
  }
  return seen;
}

// Discs at random places, as many as have the wanted area together.
void MakeHoles(double share, double diameter_m, RandomStream& stream, HeightMap& seen) {
  const double radius = diameter_m / 2 / seen.cell_size_m;  // in cells
  const double wanted = share * static_cast<double>(seen.size()) /
                        std::max(1.0, std::numbers::pi * radius * radius);
  const auto whole = static_cast<int>(wanted);
  const int count = whole + (stream.Uniform() < wanted - whole);
  if (count == 0) return;
  seen.valid.assign(seen.size(), 1);
  for (int k = 0; k < count; ++k) {
    const double x = stream.Uniform(0, seen.columns), y = stream.Uniform(0, seen.rows);
    const auto from = [&](double at) { return std::max(0, static_cast<int>(at - radius)); };
    const auto to = [&](double at, int cells) {
      return std::min(cells - 1, static_cast<int>(at + radius));
    };
    for (int row = from(y); row <= to(y, seen.rows); ++row) {
      for (int column = from(x); column <= to(x, seen.columns); ++column) {
        if (std::hypot(column + 0.5 - x, row + 0.5 - y) <= std::max(radius, 0.5))
          seen.valid[seen.Index(row, column)] = 0;
      }
    }
  }
  if (std::ranges::any_of(seen.valid, [](uint8_t v) { return v != 0; })) FillHoles(seen);
  seen.valid.clear();
}

}  // namespace

HeightMap Sense(const HeightMap& sand, const SensorConfig& config, RandomStream& stream) {
  HeightMap seen = config.registration_m > 0 ? Shift(sand, config.registration_m, stream) : sand;
  if (config.noise_m > 0) {
    for (float& h : seen.height_m) h += static_cast<float>(config.noise_m * stream.Normal());
  }
  if (config.hole_share > 0) MakeHoles(config.hole_share, config.hole_m, stream, seen);
  if (config.offset_m > 0) {
    const auto offset = static_cast<float>(config.offset_m * stream.Normal());
    for (float& h : seen.height_m) h += offset;
  }
  if (config.resolution_m > 0) {
    for (float& h : seen.height_m)
      h = static_cast<float>(config.resolution_m * std::round(h / config.resolution_m));
  }
  return seen;
}

}  // namespace sandwright
