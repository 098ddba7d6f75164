#include "agents/wedge_stroke.h"

#include <algorithm>
#include <functional>

namespace sandwright {
namespace {

constexpr Action kAboveTheSand = {0, 0, 0, -1, -1, -1, 0};

}  // namespace

WedgeLine WedgeLineOf(const Eigen::Vector2d& from_m, const Eigen::Vector2d& to_m,
                      const WedgeConfig& config, const Region& region) {
  SAND_CHECK(from_m != to_m, from_m.x(), from_m.y());
  const Eigen::Vector2d way = to_m - from_m, along = way.normalized();
  const Eigen::Vector2d low(region.x_m, region.y_m), size(region.width_m, region.depth_m);
  const Eigen::Vector2d start =
      (from_m - config.start_back_m * along).cwiseMax(low).cwiseMin(low + size);
  const double length_m = (to_m - start).dot(along) - config.end_back_m;
  return {start, along, std::clamp(length_m, kActionSpec[3].low, kActionSpec[3].high)};
}

Action WedgeStroke(const TaskView& view, const WedgeLine& line, double volume_m3,
                   const WedgeConfig& config, const Blade& blade) {
  const double wedge_m = 2 * volume_m3 / (blade.width_m * line.length_m);
  const double depth_m = std::min(config.depth_gain * wedge_m, config.most_depth_m);
  const auto point = [&](const Eigen::Vector2d& p, double below_m) {
    const double sand_m = SandUnderBlade(view.sensed, p, line.along, blade);
    return Eigen::Vector3d(p.x(), p.y(), sand_m - below_m);
  };
  return EncodeLine(point(line.start_m, depth_m), point(line.end_m(), config.end_depth_m),
                    view.sensed, view.region, blade);
}

std::vector<Action> MostFirst(const TaskView& view, std::vector<WedgeCandidate> candidates,
                              const WedgeConfig& config, const Blade& blade) {
  if (candidates.empty()) return {kAboveTheSand};
  std::ranges::stable_sort(candidates, std::greater(), &WedgeCandidate::volume_m3);
  std::vector<Action> actions;
  for (const WedgeCandidate& candidate : candidates)
    actions.push_back(WedgeStroke(view, candidate.line, candidate.volume_m3, config, blade));
  return actions;
}

}  // namespace sandwright
