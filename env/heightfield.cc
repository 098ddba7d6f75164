#include "env/heightfield.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "data/base/parallel.h"
#include "env/avalanche.h"
#include "env/blade_cut.h"

namespace sandwright {
namespace {

double TanDegrees(double angle_deg) { return std::tan(angle_deg * std::numbers::pi / 180); }

// How far any point of the blade goes between two poses, at most.
double Travel(const BladePose& a, const BladePose& b, const Blade& blade) {
  return std::hypot(b.x_m - a.x_m, b.y_m - a.y_m) + std::abs(b.yaw_rad - a.yaw_rad) * blade.width_m / 2;
}

// The path in equal steps of travel, at most `step_m` each: independent of how it was sampled.
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
    out.push_back({mix(a.x_m, b.x_m), mix(a.y_m, b.y_m), mix(a.z_m, b.z_m), mix(a.yaw_rad, b.yaw_rad)});
  }
  if (path.size() > 1) out.push_back(path.back());
  return out;
}

bool LeavesBox(const BladePose& pose, const Blade& blade, const HeightMap& map) {
  constexpr double kRounding_m = 1e-9;
  const double x = std::abs(std::sin(pose.yaw_rad)) * blade.width_m / 2 - kRounding_m;
  const double y = std::abs(std::cos(pose.yaw_rad)) * blade.width_m / 2 - kRounding_m;
  return pose.x_m - x < 0 || pose.x_m + x > map.width_m() || pose.y_m - y < 0 ||
         pose.y_m + y > map.depth_m();
}

}  // namespace

Heightfield::Heightfield(HeightfieldConfig config) : config_(config) {
  const FieldList fields = FieldsOf(config);
  LoadJson(fields, ToJson(fields), "heightfield");  // checks the ranges
}

std::vector<Outcome> Heightfield::ApplyChecked(std::span<SandState> states,
                                               std::span<const ToolPath> paths) const {
  std::vector<Outcome> outcomes(states.size());
  ParallelFor(static_cast<int>(states.size()), static_cast<int>(config_.threads), [&](int i) {
    const auto row = static_cast<size_t>(i);
    outcomes[row] = ApplyOne(states[row], paths[row]);
  });
  return outcomes;
}

Outcome Heightfield::ApplyOne(SandState& state, const ToolPath& path) const {
  HeightMap map = state.map();
  Outcome outcome;
  const double cell = map.cell_size_m;
  ToolPath poses = EqualSteps(path, config_.substep_cells * cell, config_.blade);
  for (BladePose& pose : poses) {
    outcome.left_box |= LeavesBox(pose, config_.blade, map);
    if (map.datum == Datum::kFloor && pose.z_m < 0) {
      outcome.below_floor = true;
      pose.z_m = 0;
    }
  }

  const bool floor_known = map.datum == Datum::kFloor;
  const double floor_m = floor_known ? 0 : -std::numeric_limits<double>::infinity();
  BladeCut blade(map, config_.blade, config_.cut, floor_m);
  Avalanche avalanche(map);
  const double repose_tan = TanDegrees(config_.repose_deg);
  avalanche.Disturb(blade.Plunge(poses.front()));
  for (size_t k = 1; k < poses.size(); ++k) {
    avalanche.Disturb(blade.Advance(poses[k - 1], poses[k]));
    const double diffusion_m2 = config_.relaxation_m * Travel(poses[k - 1], poses[k], config_.blade);
    avalanche.Flow(repose_tan, diffusion_m2 / (cell * cell), blade.ClosedFaces(poses[k]));
  }
  avalanche.Settle(repose_tan);
  outcome.changed = avalanche.touched();
  if (outcome.changed.empty()) return outcome;

  outcome.moved_volume_m3 = MovedVolume(state.map(), map, outcome.changed);
  SAND_CHECK(std::isfinite(outcome.moved_volume_m3));
  state.Replace(std::move(map));
  return outcome;
}

}  // namespace sandwright
