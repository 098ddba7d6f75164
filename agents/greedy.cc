#include "agents/greedy.h"

#include "agents/refine.h"
#include "agents/stroke_proposal.h"

namespace sandwright {

std::vector<Action> GreedyAgent::Act(std::span<const TaskView> views,
                                     std::span<RandomStream> streams) {
  const auto refined =
      static_cast<int64_t>(config_.refine_share * static_cast<double>(config_.evaluations));
  std::vector<Action> actions;
  for (size_t v = 0; v < views.size(); ++v) {
    const StrokeProposal proposal(views[v], config_.surplus_share);
    std::vector<StrokePlan> drawn;
    for (int64_t k = refined; k < config_.evaluations; ++k)
      drawn.push_back({proposal.Draw(streams[v])});
    std::vector<JudgedPlan> best = judge_.Judge(views[v], std::move(drawn));
    judge_.KeepBest(views[v], 1, best);
    actions.push_back(
        Refine(judge_, views[v], best.front(), refined, streams[v]).strokes.front());
  }
  return actions;
}

}  // namespace sandwright
