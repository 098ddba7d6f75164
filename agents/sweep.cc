#include "agents/sweep.h"

#include <algorithm>
#include <cmath>

#include "agents/transport.h"

namespace sandwright {
namespace {

// Volume of the flows that begin and end under a blade on its way along the line and go the same way.
double VolumeUnderBlade(const std::vector<SandFlow>& flows, const WedgeLine& line, double width_m) {
  const Eigen::Vector2d left(-line.along.y(), line.along.x());
  double sum = 0;
  for (const SandFlow& flow : flows) {
    const Eigen::Vector2d from = flow.from_m - line.start_m, to = flow.to_m - line.start_m;
    const bool beside =
        std::abs(from.dot(left)) > width_m / 2 || std::abs(to.dot(left)) > width_m / 2;
    const bool beyond =
        from.dot(line.along) < -width_m / 2 || to.dot(line.along) > line.length_m + width_m;
    if (!beside && !beyond && to.dot(line.along) > from.dot(line.along)) sum += flow.volume_m3;
  }
  return sum;
}

}  // namespace

std::vector<Action> SweepAgent::Act(std::span<const TaskView> views,
                                    std::span<RandomStream> streams) {
  std::vector<Action> actions;
  for (size_t v = 0; v < views.size(); ++v) {
    const std::vector<SandFlow> flows = OptimalTransport(views[v], config_.bin_m);
    std::vector<WedgeCandidate> candidates;
    for (const SandFlow& flow : flows) {
      const WedgeLine line = WedgeLineOf(flow.from_m, flow.to_m, config_.wedge, views[v].region);
      candidates.push_back({line, VolumeUnderBlade(flows, line, tool_.blade.width_m)});
    }
    actions.push_back(FirstAccepted(
        tool_, views[v],
        MostFirst(views[v], std::move(candidates), config_.wedge, tool_.blade), streams[v]));
  }
  return actions;
}

}  // namespace sandwright
