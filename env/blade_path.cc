#include "env/blade_path.h"

#include <algorithm>
#include <cmath>

namespace sandwright {
namespace {

bool LeavesBox(const BladePose& pose, const Blade& blade, const HeightMap& map) {
  constexpr double kRounding_m = 1e-9;
  const double x = std::abs(std::sin(pose.yaw_rad)) * blade.width_m / 2 - kRounding_m;
  const double y = std::abs(std::cos(pose.yaw_rad)) * blade.width_m / 2 - kRounding_m;
  return pose.x_m - x < 0 || pose.x_m + x > map.width_m() || pose.y_m - y < 0 ||
         pose.y_m + y > map.depth_m();
}

}  // namespace

double Travel(const BladePose& a, const BladePose& b, const Blade& blade) {
  return std::hypot(b.x_m - a.x_m, b.y_m - a.y_m) +
         std::abs(b.yaw_rad - a.yaw_rad) * blade.width_m / 2;
}

ToolPath EqualSteps(const ToolPath& path, double step_m, const Blade& blade) {
  std::vector<double> travelled = {0};
  for (size_t i = 1; i < path.size(); ++i)
    travelled.push_back(travelled.back() + Travel(path[i - 1], path[i], blade));
  const int steps = static_cast<int>(std::ceil(travelled.back() / step_m - 1e-6));
  ToolPath out = {path.front()};
  size_t i = 1;
  for (int k = 1; k < steps; ++k) {
    const double at = travelled.back() * k / steps;
    while (i + 1 < path.size() && travelled[i] < at) ++i;
    const double share = (at - travelled[i - 1]) / (travelled[i] - travelled[i - 1]);
    const auto mix = [share](double a, double b) { return a + share * (b - a); };
    const BladePose &a = path[i - 1], &b = path[i];
    out.push_back(
        {mix(a.x_m, b.x_m), mix(a.y_m, b.y_m), mix(a.z_m, b.z_m), mix(a.yaw_rad, b.yaw_rad)});
  }
  if (path.size() > 1) out.push_back(path.back());
  return out;
}

LimitedPath LimitPath(const ToolPath& path, const Blade& blade, const HeightMap& map) {
  LimitedPath limited{path};
  for (BladePose& pose : limited.path) {
    limited.left_box |= LeavesBox(pose, blade, map);
    if (map.datum == Datum::kFloor && pose.z_m < 0) {
      limited.below_floor = true;
      pose.z_m = 0;
    }
  }
  return limited;
}

}  // namespace sandwright
