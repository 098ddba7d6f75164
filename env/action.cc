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

// The number in [-1, 1] for a physical value, before bounds.
double Share(size_t entry, double physical) {
  const ActionEntry& e = kActionSpec[entry];
  return 2 * (physical - e.low) / (e.high - e.low) - 1;
}

}  // namespace

double SandUnderBlade(const HeightMap& sensed, const Eigen::Vector2d& p,
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
      SandUnderBlade(sensed, start, middle - start, blade) - Physical(action, 4);
  const double z_end = SandUnderBlade(sensed, end, end - middle, blade) - Physical(action, 5);

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

float WithinBounds(size_t entry, double value) {
  return static_cast<float>(entry == kHeadingEntry ? std::remainder(value, 2.0)
                                                   : std::clamp(value, -1.0, 1.0));
}

Action EncodeLine(const Eigen::Vector3d& start_m, const Eigen::Vector3d& end_m,
                  const HeightMap& sensed, const Region& region, const Blade& blade) {
  const Eigen::Vector2d chord = (end_m - start_m).head<2>();
  SAND_CHECK(chord.norm() > 0, start_m.x(), start_m.y());
  Action action{};
  const auto set = [&](size_t entry, double physical) {
    action[entry] = WithinBounds(entry, Share(entry, physical));
  };
  set(0, (start_m.x() - region.x_m) / region.width_m);
  set(1, (start_m.y() - region.y_m) / region.depth_m);
  set(kHeadingEntry, std::atan2(chord.y(), chord.x()));
  set(3, chord.norm());
  // The depths are counted from the sand under the ends of the line that the action stands for.
  const Eigen::Vector2d along = chord.normalized();
  const Eigen::Vector2d start(region.x_m + Physical(action, 0) * region.width_m,
                              region.y_m + Physical(action, 1) * region.depth_m);
  const Eigen::Vector2d end = start + Physical(action, 3) * along;
  set(4, SandUnderBlade(sensed, start, along, blade) - start_m.z());
  set(5, SandUnderBlade(sensed, end, along, blade) - end_m.z());
  return action;
}

}  // namespace sandwright
