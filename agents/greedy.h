// The planner that looks one stroke ahead: the best of K candidates by a sand model.
#pragma once

#include "data/base/config.h"
#include "env/agent.h"
#include "env/sand_model.h"

namespace sandwright {

class SafetyGate;

struct GreedyConfig {
  int64_t candidates = 150;
  double refine_share = 0.4;
  double surplus_share = 0.8;

  void Fields(FieldList& f) {
    f.Add("candidates", candidates, "strokes tried a stroke chosen", 1, 100000);
    f.Add("refine_share", refine_share, "share of them drawn around the best of the others", 0,
          0.95);
    f.Add("surplus_share", surplus_share,
          "share of the others that start where sand lies above the goal, the more the likelier", 0,
          1);
  }
};

class GreedyAgent final : public Agent {
 public:
  // `model` and `gate` must outlive it. With a gate, the best candidate that it accepts (coarse
  // sampling) is chosen, where there is one.
  GreedyAgent(const SandModel& model, const GreedyConfig& config, double speed_mps,
              const SafetyGate* gate = nullptr)
      : model_(model), config_(config), speed_mps_(speed_mps), gate_(gate) {}

  std::string name() const override { return "greedy"; }
  // The candidate with the least goal error by the model; all of a view's candidates are one batch.
  std::vector<Action> Act(std::span<const TaskView> views,
                          std::span<RandomStream> streams) override;
  int64_t model_evaluations() const override { return model_evaluations_; }

 private:
  struct Choice {
    Action action{};
    double error_m = 0;  // predicted
    bool accepted = false;
  };
  // The best of `candidates` and `best`; an accepted one before any other.
  Choice BestOf(const TaskView& view, std::span<const Action> candidates, Choice best);

  const SandModel& model_;
  GreedyConfig config_;
  double speed_mps_;
  const SafetyGate* gate_;
  int64_t model_evaluations_ = 0;
};

}  // namespace sandwright
