// Rewards of several steps as one transition (Hessel et al., AAAI 2018, of Sutton, 1988): what a step is worth
// reaches the steps before it sooner than by one bootstrap a step.
#pragma once

#include <deque>
#include <vector>

#include "agents/replay_buffer.h"

namespace sandwright {

class NStep {
 public:
  // Of `steps` >= 1 steps, discounted by `gamma` a step.
  NStep(const ObservationSpec& spec, int64_t steps, double gamma);

  // Takes one step of all environments, and hands on each transition that is complete by it. Where an episode
  // ended, those still open end there with fewer steps: with the episode's own last observation, and a
  // discount of 0 where it terminated.
  void Add(const ObservationBatch& before, std::span<const float> action_na, const StepBatch& step,
           ReplayBuffer& into);
  // Episodes start anew: what is still open never ends.
  void Forget() { open_.clear(); }

 private:
  struct Step {
    std::vector<float> observation, action;
    float reward;
  };
  // The oldest open step of `episode`, with the rewards of all of them.
  void Emit(std::deque<Step>& episode, std::span<const float> after, bool terminated,
            ReplayBuffer& into) const;

  size_t map_size_, vec_size_, steps_;
  double gamma_;
  std::vector<std::deque<Step>> open_;  // one an environment, oldest first
};

}  // namespace sandwright
