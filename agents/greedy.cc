#include "agents/greedy.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "agents/stroke_proposals.h"
#include "data/task.h"
#include "robot_model/safety_gate.h"

namespace sandwright {
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
    const SurplusProposals proposals(views[v], config_.surplus_share);
    std::vector<Action> candidates;
    for (size_t k = 0; k < drawn; ++k) candidates.push_back(proposals.Draw(stream));
    Choice best =
        BestOf(views[v], candidates, {.error_m = std::numeric_limits<double>::infinity()});
    candidates.clear();
    for (size_t k = 0; k < refined; ++k) candidates.push_back(Near(best.action, stream));
    actions.push_back(BestOf(views[v], candidates, best).action);
  }
  return actions;
}

}  // namespace sandwright
