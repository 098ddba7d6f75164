// A trained policy as an agent: one forward pass a stroke, no sand model.
#pragma once

#include <memory>
#include <string>

#include "agents/policy_file.h"
#include "env/agent.h"

namespace sandwright {

class PolicyAgent final : public Agent {
 public:
  PolicyAgent(std::string name, Policy policy, torch::Device device)
      : name_(std::move(name)),
        card_(policy.card),
        owned_(std::move(policy.actor)),
        actor_(*owned_),
        device_(device) {}
  // Looks at an actor in training, which must outlive it.
  PolicyAgent(std::string name, const PolicyCard& card, Actor& actor, torch::Device device)
      : name_(std::move(name)), card_(card), actor_(actor), device_(device) {}

  std::string name() const override { return name_; }
  std::optional<std::array<double, 2>> region_size_m() const override {
    return {{card_.region_width_m, card_.region_depth_m}};
  }
  // The deterministic action of the policy. Where the last stroke was
  // rejected the sand is as it was, so that the same stroke would come again: there the
  // action is drawn from the policy. Throws Error where a view's region is of another
  // size than the one the policy was trained in.
  std::vector<Action> Act(std::span<const TaskView> views,
                          std::span<RandomStream> streams) override;
  // `count` actions drawn from the policy for one view.
  std::vector<Action> Samples(const TaskView& view, RandomStream& stream, int64_t count);

 private:
  // What the network sees of the views, a row each. Throws as Act.
  ObservationTensors Observe(std::span<const TaskView> views) const;

  std::string name_;
  PolicyCard card_;
  std::unique_ptr<Actor> owned_;
  Actor& actor_;
  torch::Device device_;
};

}  // namespace sandwright
