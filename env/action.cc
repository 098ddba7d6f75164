#include "env/action.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace sandwright {
namespace {

constexpr double kTolerance = 1e-6;

// The physical value of one number of an action.
double Physical(const Action& action, int i) {
  const ActionEntry& entry = kActionSpec[static_cast<size_t>(i)];
  const float a = action[static_cast<size_t>(i)];
  if (!(std::abs(a) <= 1 + kTolerance))
    throw Error(fmt::format("action[{}] ({}) = {}; allowed: [-1, 1]", i, entry.name, a));
  const double share = (std::clamp(static_cast<double>(a), -1.0, 1.0) + 1) / 2;
  return entry.low + share * (entry.high - entry.low);
}

// Mean sensed height [m] under a blade that stands at `p` and travels along `direction`.
double MeanHeightUnderBlade(const HeightMap& sensed, const Eigen::Vector2d& p,
                            const Eigen::Vector2d& direction, const Blade& blade) {
  constexpr int kAcross = 9, kAlong = 3;  // samples at the middles of equal parts of the footprint
  const Eigen::Vector2d along = direction.normalized();
  const Eigen::Vector2d across(-along.y(), along.x());
  double sum = 0;
  for (int a = 0; a < kAcross; ++a) {
    for (int b = 0; b < kAlong; ++b) {
      const Eigen::Vector2d q = p + ((a + 0.5) / kAcross - 0.5) * blade.width_m * across +
                                ((b + 0.5) / kAlong - 0.5) * blade.thickness_m * along;
      sum += HeightAt(sensed, q.x(), q.y());
    }
  }
  return sum / (kAcross * kAlong);
}

}  // namespace

Stroke DecodeAction(const Action& action, const HeightMap& sensed, const Region& region,
                    const Blade& blade, double speed_mps) {
  const Eigen::Vector2d start(region.x_m + Physical(action, 0) * region.width_m,
                              region.y_m + Physical(action, 1) * region.depth_m);
  const double heading_rad = Physical(action, 2), length_m = Physical(action, 3);
  const double bend = Physical(action, 6);
  const Eigen::Vector2d along(std::cos(heading_rad), std::sin(heading_rad));
  const Eigen::Vector2d left(-along.y(), along.x());
  const Eigen::Vector2d end = start + length_m * along;
  // Also the tangents at the ends: towards and from the middle control point.
  const Eigen::Vector2d middle = (start + end) / 2 + bend * length_m * left;
  const double z_start =
      MeanHeightUnderBlade(sensed, start, middle - start, blade) - Physical(action, 4);
  const double z_end = MeanHeightUnderBlade(sensed, end, end - middle, blade) - Physical(action, 5);

  Stroke stroke;
  stroke.speed_mps = speed_mps;
  stroke.control_points_m = {{start.x(), start.y(), z_start}, {end.x(), end.y(), z_end}};
  if (bend != 0) {
    stroke.degree = 2;
    stroke.control_points_m.insert(stroke.control_points_m.begin() + 1,
                                   {middle.x(), middle.y(), (z_start + z_end) / 2});
  }
  return stroke;
}

}  // namespace sandwright
