#include "agents/ranked.h"

#include "agents/refine.h"

namespace sandwright {

std::vector<Action> RankedAgent::Act(std::span<const TaskView> views,
                                     std::span<RandomStream> streams) {
  const auto refined =
      static_cast<int64_t>(config_.refine_share * static_cast<double>(config_.evaluations));
  std::vector<Action> actions;
  for (size_t v = 0; v < views.size(); ++v) {
    // One view at a time: the last bits of a network's output may depend on what else is in a batch.
    std::vector<StrokePlan> plans = {policy_->Act(views.subspan(v, 1), streams.subspan(v, 1))};
    for (const Action& action :
         policy_->Samples(views[v], streams[v], config_.evaluations - refined - 1))
      plans.push_back({action});
    std::vector<JudgedPlan> best = judge_.Judge(views[v], std::move(plans));
    judge_.KeepBest(views[v], 1, best);
    actions.push_back(
        Refine(judge_, views[v], best.front(), refined, streams[v]).strokes.front());
  }
  return actions;
}

}  // namespace sandwright
