#include "data/excavation.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr int kDraws = 1000;

struct Interval {
  double low, high;
};

// Where points may lie along one axis of the box: a random place for the cube, margins kept.
Interval PlaceCube(const ExcavationConfig& config, double extent_m, RandomStream& stream) {
  const double room = extent_m - 2 * config.wall_margin_m, side = std::min(config.cube_m, room);
  const double low = config.wall_margin_m + stream.Uniform() * (room - side);
  return {low, low + side};
}

// Height of a control point over terrain of height `surface_m`.
double DrawHeight(const ExcavationConfig& config, double surface_m, RandomStream& stream) {
  return std::max(config.floor_margin_m,
                  surface_m - stream.Uniform(-config.above_m, config.deepest_m));
}

bool IsAllowed(const Stroke& stroke) {
  try {
    CheckStroke(stroke, "draw");
    return true;
  } catch (const Error&) {
    return false;
  }
}

Stroke DrawOfClass(char wanted, const ExcavationConfig& config, const HeightMap& terrain,
                   RandomStream& stream) {
  // Points from, and how many more at most, of each class.
  const auto [fewest, extra] = [&]() -> std::pair<uint64_t, uint64_t> {
    switch (wanted) {
      case 'A': return {2, 0};
      case 'C': return {2, 1};
      case 'E': return {4, 0};
      default: return {3, 1};
    }
  }();
  const bool flat = wanted == 'A' || wanted == 'B' || wanted == 'D';
  Stroke stroke;
  stroke.degree = wanted == 'D' || wanted == 'F' ? 2 : 1;
  stroke.speed_mps = config.speed_mps;
  const Interval xs = PlaceCube(config, terrain.width_m(), stream);
  const Interval ys = PlaceCube(config, terrain.depth_m(), stream);
  const uint64_t count = fewest + stream.Index(extra + 1);
  double mean_surface_m = 0;
  for (uint64_t i = 0; i < count; ++i) {
    const double x = stream.Uniform(xs.low, xs.high), y = stream.Uniform(ys.low, ys.high);
    const double surface_m = HeightAt(terrain, x, y);
    mean_surface_m += surface_m / static_cast<double>(count);
    stroke.control_points_m.emplace_back(x, y, flat ? 0 : DrawHeight(config, surface_m, stream));
  }
  if (flat) {
    const double z = DrawHeight(config, mean_surface_m, stream);
    for (auto& point : stroke.control_points_m) point.z() = z;
  }
  return stroke;
}

}  // namespace

Stroke DrawStroke(const ExcavationConfig& config, const HeightMap& terrain, RandomStream& stream) {
  const double least = 2 * config.wall_margin_m + config.shortest_m;
  if (std::min(terrain.width_m(), terrain.depth_m()) <= least)
    throw Error(fmt::format(
        "box of {:g} x {:g} m: strokes of at least {:g} m, {:g} m from the walls, need more than "
        "{:g} m",
        terrain.width_m(), terrain.depth_m(), config.shortest_m, config.wall_margin_m, least));
  const char wanted = static_cast<char>('A' + stream.Index(6));
  for (int draw = 0; draw < kDraws; ++draw) {
    Stroke stroke = DrawOfClass(wanted, config, terrain, stream);
    const auto [low, high] = std::ranges::minmax(stroke.control_points_m, {},
                                                 [](const Eigen::Vector3d& p) { return p.z(); });
    if (high.z() - low.z() > config.cube_m || !IsAllowed(stroke)) continue;
    if (ComplexityClass(stroke) == wanted && PathLength(stroke) >= config.shortest_m) return stroke;
  }
  throw Error(fmt::format(
      "no stroke of class {} in {} draws: depths from floor_margin_m = {:g} m to {:g} m above the "
      "sand leave no room",
      wanted, kDraws, config.floor_margin_m, config.above_m));
}

}  // namespace sandwright
