// A genetic algorithm over the next strokes, on a sand model.
#pragma once

#include "agents/planning_budget.h"
#include "agents/stroke_judge.h"
#include "data/base/config.h"

namespace sandwright {

struct GaConfig {
  int64_t evaluations = 150;
  int64_t horizon = 1;
  int64_t generations = 5;
  int64_t parents = 4;
  double crossover_rate = 0.5;
  double mutation_rate = 0.5;
  double mutation_spread = 0.2;
  double surplus_share = 0.8;

  void Fields(FieldList& f) {
    f.Add("evaluations", evaluations,
          "model evaluations a stroke, at most: horizon times the plans tried", 1, 1000000);
    f.Add("horizon", horizon, "strokes of a plan, of which the first is executed", 1, 20);
    f.Add("generations", generations, "rounds of plans, the first drawn at random", 1, 1000);
    f.Add("parents", parents, "best plans so far that have children", 1, 10000);
    f.Add("crossover_rate", crossover_rate, "share of children with two parents", 0, 1);
    f.Add("mutation_rate", mutation_rate, "share of a child's numbers that change", 0, 1);
    f.Add("mutation_spread", mutation_spread, "sd of such a change, on [-1, 1]", 0.001, 2);
    f.Add("surplus_share", surplus_share,
          "share of the first round's strokes that start where sand lies above the goal", 0, 1);
  }
};

class GaAgent final : public Agent {
 public:
  // Throws Error where `evaluations` is less than one plan a round.
  GaAgent(const StrokeJudge& judge, const GaConfig& config)
      : judge_(judge),
        config_(config),
        budget_("ga", config.evaluations, config.horizon, config.generations) {}

  std::string name() const override { return "ga"; }
  // The first stroke of the best plan of all generations; one that the gate accepts before any other.
  std::vector<Action> Act(std::span<const TaskView> views,
                          std::span<RandomStream> streams) override;
  int64_t model_evaluations() const override { return judge_.model_evaluations(); }

 private:
  Action Choose(const TaskView& view, RandomStream& stream);
  StrokePlan Child(std::span<const JudgedPlan> parents, RandomStream& stream) const;

  StrokeJudge judge_;
  GaConfig config_;
  PlanningBudget budget_;
};

}  // namespace sandwright
