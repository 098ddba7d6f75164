// The last transitions of all environments, drawn from evenly.
#pragma once

#include <torch/torch.h>

#include <span>
#include <string>
#include <vector>

#include "data/base/random.h"
#include "env/safetensors.h"
#include "env/vec_env.h"

namespace sandwright {

// B transitions on one device.
struct Transitions {
  torch::Tensor observation, action, next_observation;  // [B, V], [B, A], [B, V]
  torch::Tensor reward, goes_on;  // [B, 1]; goes_on: 0 where the episode terminated, else 1
};

// Observations without a map. Memory grows until `capacity` transitions are there; then the oldest
// is overwritten.
class ReplayBuffer {
 public:
  ReplayBuffer(int64_t observation_size, int64_t action_size, int64_t capacity);

  // One transition a row. What follows a step is the new episode's start only in `step.observation`:
  // where the episode ended, its own last observation is kept. A truncated one goes on from there.
  void Add(const ObservationBatch& before, std::span<const float> action_na, const StepBatch& step);
  int64_t size() const { return static_cast<int64_t>(values_.size()) / row_size(); }

  // Independent draws; size() > 0.
  Transitions Sample(int64_t count, RandomStream& stream, torch::Device device) const;

  void Save(Safetensors& content) const;
  // Throws Error naming `source` where the rows are of another size or more than the capacity.
  void Load(const Safetensors& content, const std::string& source);

 private:
  int64_t row_size() const { return 2 * observation_size_ + action_size_ + 2; }

  int64_t observation_size_, action_size_, capacity_;
  int64_t next_ = 0;           // row that is written next
  std::vector<float> values_;  // [size, row_size]: observation, action, next observation, reward,
                               // goes_on
};

}  // namespace sandwright
