#include "agents/boustrophedon.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "agents/lane.h"

namespace sandwright {
namespace {

// What of the line through `p` along `along` lies in the region, as distances from `p` [m].
std::pair<double, double> Inside(const Region& region, const Eigen::Vector2d& p,
                                 const Eigen::Vector2d& along) {
  const Eigen::Vector2d low(region.x_m, region.y_m), size(region.width_m, region.depth_m);
  double from = -size.norm(), to = size.norm();
  for (int axis = 0; axis < 2; ++axis) {
    if (std::abs(along[axis]) < 1e-9) continue;
    const double a = (low[axis] - p[axis]) / along[axis];
    const double b = (low[axis] + size[axis] - p[axis]) / along[axis];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return {from, to};
}

// Lanes along `along` side by side over the region, its middle in the middle.
std::vector<Lane> Lanes(const TaskView& view, const Eigen::Vector2d& along, double spacing_m,
                        double width_m) {
  const Region& region = view.region;
  const Eigen::Vector2d size(region.width_m, region.depth_m), left(-along.y(), along.x());
  const Eigen::Vector2d middle = Eigen::Vector2d(region.x_m, region.y_m) + size / 2;
  const double room_m = size.dot(left.cwiseAbs());
  const int count = std::max(1, static_cast<int>(room_m / spacing_m + 1e-6));
  std::vector<Lane> lanes;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector2d p = middle + (k - (count - 1) / 2.0) * spacing_m * left;
    const auto [from, to] = Inside(region, p, along);
    if (to > from) lanes.push_back(LaneOf(view, p + from * along, along, to - from, width_m));
  }
  return lanes;
}

}  // namespace

std::vector<Action> BoustrophedonAgent::Act(std::span<const TaskView> views,
                                            std::span<RandomStream> streams) {
  const double width_m = tool_.blade.width_m;
  const double longest_m =
      kActionSpec[3].high + config_.wedge.end_back_m - config_.wedge.start_back_m;
  std::vector<Action> actions;
  for (size_t v = 0; v < views.size(); ++v) {
    std::vector<WedgeCandidate> candidates;
    for (int64_t k = 0; k < config_.headings; ++k) {
      const double heading_rad =
          2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(config_.headings);
      const Eigen::Vector2d along(std::cos(heading_rad), std::sin(heading_rad));
      for (const Lane& lane : Lanes(views[v], along, config_.lane_spacing * width_m, width_m)) {
        for (const Pass& pass : PassesOf(lane, longest_m))
          candidates.push_back({WedgeLineOf(lane.At(pass.first), lane.At(pass.last), config_.wedge,
                                            views[v].region),
                                pass.area_m2 * width_m});
      }
    }
    actions.push_back(FirstAccepted(
        tool_, views[v],
        MostFirst(views[v], std::move(candidates), config_.wedge, tool_.blade), streams[v]));
  }
  return actions;
}

}  // namespace sandwright
