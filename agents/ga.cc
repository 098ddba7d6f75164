// Truncation selection of the best of parents and children, uniform crossover (Syswerda 1989) and normal
// mutation.
#include "agents/ga.h"

#include <algorithm>
#include <iterator>

#include "agents/stroke_proposal.h"

namespace sandwright {

StrokePlan GaAgent::Child(std::span<const JudgedPlan> parents, RandomStream& stream) const {
  const StrokePlan& mother = parents[stream.Index(parents.size())].strokes;
  const StrokePlan& father = parents[stream.Index(parents.size())].strokes;
  const bool crossed = stream.Uniform() < config_.crossover_rate;
  StrokePlan child = mother;
  for (size_t s = 0; s < child.size(); ++s) {
    for (size_t i = 0; i < child[s].size(); ++i) {
      if (crossed && stream.Uniform() < 0.5) child[s][i] = father[s][i];
      if (stream.Uniform() < config_.mutation_rate)
        child[s][i] = WithinBounds(i, child[s][i] + config_.mutation_spread * stream.Normal());
    }
  }
  return child;
}

Action GaAgent::Choose(const TaskView& view, RandomStream& stream) {
  const StrokeProposal proposal(view, config_.surplus_share);
  const size_t strokes = budget_.StrokesAhead(view);
  std::vector<JudgedPlan> parents;
  for (int64_t count : budget_.PlansByRound(strokes)) {
    const bool first = parents.empty();
    std::vector<StrokePlan> plans;
    for (int64_t k = 0; k < count; ++k)
      plans.push_back(first ? proposal.Draw(strokes, stream) : Child(parents, stream));
    std::ranges::move(judge_.Judge(view, std::move(plans)), std::back_inserter(parents));
    judge_.KeepBest(view, static_cast<size_t>(config_.parents), parents);
  }
  return parents.front().strokes.front();
}

std::vector<Action> GaAgent::Act(std::span<const TaskView> views,
                                 std::span<RandomStream> streams) {
  std::vector<Action> actions;
  for (size_t v = 0; v < views.size(); ++v) actions.push_back(Choose(views[v], streams[v]));
  return actions;
}

}  // namespace sandwright
