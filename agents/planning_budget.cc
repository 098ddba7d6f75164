#include "agents/planning_budget.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

namespace sandwright {

PlanningBudget::PlanningBudget(const std::string& planner, int64_t evaluations, int64_t horizon,
                               int64_t rounds)
    : evaluations_(evaluations), horizon_(horizon), rounds_(rounds) {
  if (evaluations < horizon * rounds)
    throw Error(fmt::format("{}.evaluations = {}: {} rounds of plans of {} strokes need at least {}",
                            planner, evaluations, rounds, horizon, horizon * rounds));
}

size_t PlanningBudget::StrokesAhead(const TaskView& view) const {
  return static_cast<size_t>(
      std::clamp<int64_t>(view.max_strokes - view.strokes_used, 1, horizon_));
}

std::vector<int64_t> PlanningBudget::PlansByRound(size_t strokes) const {
  const int64_t plans = evaluations_ / static_cast<int64_t>(strokes);
  std::vector<int64_t> by_round;
  for (int64_t r = 0; r < rounds_; ++r)
    by_round.push_back(plans * (r + 1) / rounds_ - plans * r / rounds_);
  return by_round;
}

}  // namespace sandwright
