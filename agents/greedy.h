// The planner that looks one stroke ahead: the best of K candidates by a sand model.
#pragma once

#include "agents/stroke_judge.h"
#include "data/base/config.h"

namespace sandwright {

struct GreedyConfig {
  int64_t evaluations = 150;
  double refine_share = 0.4;
  double surplus_share = 0.8;

  void Fields(FieldList& f) {
    f.Add("evaluations", evaluations, "model evaluations a stroke: strokes tried", 1, 100000);
    f.Add("refine_share", refine_share, "share of them drawn around the best of the others", 0,
          0.95);
    f.Add("surplus_share", surplus_share,
          "share of the others that start where sand lies above the goal, the more the likelier", 0,
          1);
  }
};

class GreedyAgent final : public Agent {
 public:
  GreedyAgent(const StrokeJudge& judge, const GreedyConfig& config)
      : judge_(judge), config_(config) {}

  std::string name() const override { return "greedy"; }
  // The accepted candidate with the least goal error by the model; any, where none is accepted.
  std::vector<Action> Act(std::span<const TaskView> views,
                          std::span<RandomStream> streams) override;
  int64_t model_evaluations() const override { return judge_.model_evaluations(); }

 private:
  StrokeJudge judge_;
  GreedyConfig config_;
};

}  // namespace sandwright
