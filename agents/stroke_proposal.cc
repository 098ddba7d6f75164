#include "agents/stroke_proposal.h"

#include <algorithm>

namespace sandwright {
namespace {

std::vector<double> CumulativeSurplus(const HeightMap& map, const HeightMap& goal) {
  std::vector<double> sum(map.size());
  double total = 0;
  for (size_t i = 0; i < map.size(); ++i) {
    if (goal.mask[i]) total += std::max(0.0f, map.height_m[i] - goal.height_m[i]);
    sum[i] = total;
  }
  return sum;
}

}  // namespace

Action RandomAction(RandomStream& stream) {
  Action action{};
  for (float& number : action) number = static_cast<float>(stream.Uniform(-1, 1));
  return action;
}

StrokeProposal::StrokeProposal(const TaskView& view, double surplus_share)
    : surplus_share_(surplus_share),
      region_(view.region),
      columns_(view.sensed.columns),
      cell_m_(view.sensed.cell_size_m),
      cumulative_surplus_m_(CumulativeSurplus(view.sensed, view.goal)) {}

Action StrokeProposal::Draw(RandomStream& stream) const {
  Action action = RandomAction(stream);
  const double total = cumulative_surplus_m_.back();
  if (!(total > 0) || stream.Uniform() >= surplus_share_) return action;
  const auto found = std::ranges::upper_bound(cumulative_surplus_m_, stream.Uniform() * total);
  const auto cell = static_cast<int>(
      std::min(found, cumulative_surplus_m_.end() - 1) - cumulative_surplus_m_.begin());
  const double x_m = (cell % columns_ + stream.Uniform()) * cell_m_;
  const double y_m = (cell / columns_ + stream.Uniform()) * cell_m_;
  // Surplus outside the region, which no action reaches, moves to the region's edge.
  action[0] = WithinBounds(0, 2.0 * (x_m - region_.x_m) / region_.width_m - 1.0);
  action[1] = WithinBounds(1, 2.0 * (y_m - region_.y_m) / region_.depth_m - 1.0);
  return action;
}

std::vector<Action> StrokeProposal::Draw(size_t count, RandomStream& stream) const {
  std::vector<Action> actions;
  for (size_t k = 0; k < count; ++k) actions.push_back(Draw(stream));
  return actions;
}

}  // namespace sandwright
