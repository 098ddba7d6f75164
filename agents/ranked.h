// A policy's own samples, ranked by a sand model.
#pragma once

#include <memory>

#include "agents/policy_agent.h"
#include "agents/ranked_config.h"
#include "agents/stroke_judge.h"

namespace sandwright {

class RankedAgent final : public Agent {
 public:
  RankedAgent(const StrokeJudge& judge, std::unique_ptr<PolicyAgent> policy,
              const RankedConfig& config)
      : judge_(judge), policy_(std::move(policy)), config_(config) {}

  std::string name() const override { return "ranked"; }
  std::optional<std::array<double, 2>> region_size_m() const override {
    return policy_->region_size_m();
  }
  // Of what the policy would do (after a rejected stroke, a sample), its samples, and strokes drawn
  // around the best of these: the accepted one with the least goal error by the model; any, where
  // none is accepted. Throws as PolicyAgent::Act.
  std::vector<Action> Act(std::span<const TaskView> views,
                          std::span<RandomStream> streams) override;
  int64_t model_evaluations() const override { return judge_.model_evaluations(); }

 private:
  StrokeJudge judge_;
  std::unique_ptr<PolicyAgent> policy_;
  RankedConfig config_;
};

}  // namespace sandwright
