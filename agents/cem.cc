// Rubinstein, "The cross-entropy method for combinatorial and continuous optimization" (1999). The best
// plans of all rounds stay elites (Pinneri et al., iCEM, 2020): the model has no noise, so keeping
// them costs nothing.
#include "agents/cem.h"

#include <algorithm>
#include <iterator>

#include "agents/plan_distribution.h"
#include "agents/stroke_proposal.h"

namespace sandwright {

Action CemAgent::Choose(const TaskView& view, RandomStream& stream) {
  const StrokeProposal proposal(view, config_.surplus_share);
  const size_t strokes = budget_.StrokesAhead(view);
  PlanDistribution distribution;
  std::vector<JudgedPlan> elites;
  for (int64_t count : budget_.PlansByRound(strokes)) {
    const bool first = elites.empty();
    std::vector<StrokePlan> plans;
    for (int64_t k = 0; k < count; ++k)
      plans.push_back(first ? proposal.Draw(strokes, stream)
                            : distribution.Draw(config_.least_sd, stream));
    std::ranges::move(judge_.Judge(view, std::move(plans)), std::back_inserter(elites));
    judge_.KeepBest(view, static_cast<size_t>(config_.elites), elites);
    const PlanDistribution fit = PlanDistribution::Fit(elites);
    if (first) distribution = fit;
    distribution.Approach(fit, config_.smoothing);
  }
  return elites.front().strokes.front();
}

std::vector<Action> CemAgent::Act(std::span<const TaskView> views,
                                  std::span<RandomStream> streams) {
  std::vector<Action> actions;
  for (size_t v = 0; v < views.size(); ++v) actions.push_back(Choose(views[v], streams[v]));
  return actions;
}

}  // namespace sandwright
