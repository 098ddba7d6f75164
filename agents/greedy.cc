#include "agents/greedy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "data/task.h"
#include "robot_model/safety_gate.h"

namespace sandwright {
namespace {

constexpr double kRefineSpread = 0.15;  // sd of a refined number around the best, on [-1, 1]

// Sand above the goal at each counted cell inside the region, summed up in row-major order.
std::vector<double> CumulativeSurplus(const TaskView& view) {
  const HeightMap &map = view.sensed, &goal = view.goal;
  std::vector<double> sum(map.size());
  double total = 0;
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const size_t i = map.Index(row, column);
      if (goal.mask[i]) total += std::max(0.0f, map.height_m[i] - goal.height_m[i]);
      sum[i] = total;
    }
  }
  return sum;
}

Action RandomAction(RandomStream& stream) {
  Action action{};
  for (float& number : action) number = static_cast<float>(stream.Uniform(-1, 1));
  return action;
}

// Puts the start somewhere in a cell drawn by its surplus. Surplus outside the region, which no
// action reaches, moves to the region's edge.
void StartAtSurplus(const TaskView& view, const std::vector<double>& cumulative,
                    RandomStream& stream, Action& action) {
  const double cell_m = view.sensed.cell_size_m;
  const auto found = std::ranges::upper_bound(cumulative, stream.Uniform() * cumulative.back());
  const auto i = static_cast<int>(
      std::min<int64_t>(found - cumulative.begin(), static_cast<int64_t>(cumulative.size()) - 1));
  const double x_m = (i % view.sensed.columns + stream.Uniform()) * cell_m;
  const double y_m = (i / view.sensed.columns + stream.Uniform()) * cell_m;
  const auto number = [](double at_m, double low_m, double extent_m) {
    return static_cast<float>(std::clamp(2.0 * (at_m - low_m) / extent_m - 1.0, -1.0, 1.0));
  };
  action[0] = number(x_m, view.region.x_m, view.region.width_m);
  action[1] = number(y_m, view.region.y_m, view.region.depth_m);
}

// The heading wraps around; the other numbers stop at their bounds.
Action Near(const Action& best, RandomStream& stream) {
  Action action = best;
  for (size_t i = 0; i < action.size(); ++i) {
    const double moved = best[i] + kRefineSpread * stream.Normal();
    action[i] =
        static_cast<float>(i == 2 ? std::remainder(moved, 2.0) : std::clamp(moved, -1.0, 1.0));
  }
  return action;
}

}  // namespace

GreedyAgent::Choice GreedyAgent::BestOf(const TaskView& view, std::span<const Action> candidates,
                                        Choice best) {
  std::vector<SandState> states(candidates.size(), model_.Start(view.sensed, 0));
  std::vector<Stroke> strokes;
  for (const Action& action : candidates)
    strokes.push_back(DecodeAction(action, view.sensed, view.region, model_.blade(), speed_mps_));
  model_.Apply(states, strokes);
  model_evaluations_ += static_cast<int64_t>(candidates.size());
  std::vector<double> error_m;
  for (const SandState& state : states) error_m.push_back(GoalError(state.map(), view.goal));
  std::vector<size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, {}, [&](size_t i) { return error_m[i]; });
  for (size_t i : order) {  // best first, so that few meet the gate
    if (best.accepted && error_m[i] >= best.error_m) break;
    const bool accepted =
        !gate_ || gate_->Check(strokes[i], view.sensed, GateSampling::kCoarse).accepted;
    const bool better = accepted == best.accepted ? error_m[i] < best.error_m : accepted;
    if (better) best = {candidates[i], error_m[i], accepted};
  }
  return best;
}

std::vector<Action> GreedyAgent::Act(std::span<const TaskView> views,
                                     std::span<RandomStream> streams) {
  const auto refined =
      static_cast<size_t>(config_.refine_share * static_cast<double>(config_.candidates));
  const size_t drawn = static_cast<size_t>(config_.candidates) - refined;
  std::vector<Action> actions;
  for (size_t v = 0; v < views.size(); ++v) {
    RandomStream& stream = streams[v];
    const std::vector<double> surplus = CumulativeSurplus(views[v]);
    std::vector<Action> candidates;
    for (size_t k = 0; k < drawn; ++k) {
      candidates.push_back(RandomAction(stream));
      if (surplus.back() > 0 && stream.Uniform() < config_.surplus_share)
        StartAtSurplus(views[v], surplus, stream, candidates.back());
    }
    Choice best =
        BestOf(views[v], candidates, {.error_m = std::numeric_limits<double>::infinity()});
    candidates.clear();
    for (size_t k = 0; k < refined; ++k) candidates.push_back(Near(best.action, stream));
    actions.push_back(BestOf(views[v], candidates, best).action);
  }
  return actions;
}

}  // namespace sandwright
