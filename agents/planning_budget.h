// How a planner's budget of model evaluations becomes rounds of plans.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "env/agent.h"

namespace sandwright {

class PlanningBudget {
 public:
  // `evaluations` a stroke for plans of `horizon` strokes in `rounds` rounds. Throws Error naming
  // the key PLANNER.evaluations where a round would be without a plan.
  PlanningBudget(const std::string& planner, int64_t evaluations, int64_t horizon, int64_t rounds);

  // Strokes of a plan: the horizon, or what is left of the task's budget.
  size_t StrokesAhead(const TaskView& view) const;
  // Plans of `strokes` strokes in each round; one evaluation a stroke makes `evaluations` at most.
  std::vector<int64_t> PlansByRound(size_t strokes) const;

 private:
  int64_t evaluations_, horizon_, rounds_;
};

}  // namespace sandwright
