// The cross-entropy method over the next strokes, on a sand model.
#pragma once

#include "agents/planning_budget.h"
#include "agents/stroke_judge.h"
#include "data/base/config.h"

namespace sandwright {

struct CemConfig {
  int64_t evaluations = 150;
  int64_t horizon = 1;
  int64_t iterations = 4;
  int64_t elites = 3;
  double smoothing = 0.1;
  double least_sd = 0.05;
  double surplus_share = 0.8;

  void Fields(FieldList& f) {
    f.Add("evaluations", evaluations,
          "model evaluations a stroke, at most: horizon times the plans tried", 1, 1000000);
    f.Add("horizon", horizon, "strokes of a plan, of which the first is executed", 1, 20);
    f.Add("iterations", iterations, "rounds of drawing plans", 1, 1000);
    f.Add("elites", elites, "best plans so far that the next round is drawn like", 1, 10000);
    f.Add("smoothing", smoothing, "share of the last round's mean and sd that is kept", 0, 0.99);
    f.Add("least_sd", least_sd, "no number is drawn with a smaller sd, on [-1, 1]", 0, 1);
    f.Add("surplus_share", surplus_share,
          "share of the first round's strokes that start where sand lies above the goal", 0, 1);
  }
};

class CemAgent final : public Agent {
 public:
  // Throws Error where `evaluations` is less than one plan a round.
  CemAgent(const StrokeJudge& judge, const CemConfig& config)
      : judge_(judge),
        config_(config),
        budget_("cem", config.evaluations, config.horizon, config.iterations) {}

  std::string name() const override { return "cem"; }
  // The first stroke of the best plan of all rounds; one that the gate accepts before any other.
  std::vector<Action> Act(std::span<const TaskView> views,
                          std::span<RandomStream> streams) override;
  int64_t model_evaluations() const override { return judge_.model_evaluations(); }

 private:
  Action Choose(const TaskView& view, RandomStream& stream);

  StrokeJudge judge_;
  CemConfig config_;
  PlanningBudget budget_;
};

}  // namespace sandwright
