#include "agents/stroke_proposals.h"

#include <algorithm>
#include <cmath>

namespace sandwright {
namespace {
constexpr double kNearSpread = 0.15;
}  // namespace

SurplusProposals::SurplusProposals(const TaskView& view, double surplus_share)
    : map_(view.sensed), region_(view.region), surplus_share_(surplus_share) {
  double total = 0;
  for (size_t i = 0; i < map_.size(); ++i) {
    if (view.goal.mask[i]) total += std::max(0.0f, map_.height_m[i] - view.goal.height_m[i]);
    cumulative_.push_back(total);
  }
}

Action SurplusProposals::Draw(RandomStream& stream) const {
  Action action{};
  for (float& number : action) number = static_cast<float>(stream.Uniform(-1, 1));
  if (cumulative_.back() <= 0 || stream.Uniform() >= surplus_share_) return action;
  const auto found =
      std::ranges::upper_bound(cumulative_, stream.Uniform() * cumulative_.back());
  const auto i = static_cast<int>(std::min<int64_t>(found - cumulative_.begin(),
                                                    static_cast<int64_t>(cumulative_.size()) - 1));
  const double x_m = (i % map_.columns + stream.Uniform()) * map_.cell_size_m;
  const double y_m = (i / map_.columns + stream.Uniform()) * map_.cell_size_m;
  // Surplus outside the region, which no action reaches, moves to the region's edge.
  const auto number = [](double at_m, double low_m, double extent_m) {
    return static_cast<float>(std::clamp(2.0 * (at_m - low_m) / extent_m - 1.0, -1.0, 1.0));
  };
  action[0] = number(x_m, region_.x_m, region_.width_m);
  action[1] = number(y_m, region_.y_m, region_.depth_m);
  return action;
}

Action Near(const Action& best, RandomStream& stream) {
  Action action = best;
  for (size_t i = 0; i < action.size(); ++i) {
    const double moved = best[i] + kNearSpread * stream.Normal();
    action[i] =
        static_cast<float>(i == 2 ? std::remainder(moved, 2.0) : std::clamp(moved, -1.0, 1.0));
  }
  return action;
}

}  // namespace sandwright
