// The last transitions of all environments, drawn from evenly.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "agents/tensors.h"
#include "data/base/random.h"
#include "env/safetensors.h"

namespace sandwright {

// B transitions on one device.
struct Transitions {
  ObservationTensors observation;
  torch::Tensor action;  // [B, A]
  ObservationTensors next_observation;
  torch::Tensor reward, discount;  // [B, 1]; discount: of the value of what followed, 0 where the episode terminated
};

// Memory grows until `capacity` transitions are there; then the oldest is overwritten.
class ReplayBuffer {
 public:
  ReplayBuffer(const ObservationSpec& spec, int64_t action_size, int64_t capacity);

  // Observations: the map, then the numbers.
  void Add(std::span<const float> observation, std::span<const float> action,
           std::span<const float> next_observation, float reward, float discount);
  int64_t size() const { return static_cast<int64_t>(values_.size()) / row_size(); }

  // Independent draws; size() > 0.
  Transitions Sample(int64_t count, RandomStream& stream, torch::Device device) const;

  void Save(Safetensors& content) const;
  // Throws Error naming `source` where the rows are of another size or more than the capacity.
  void Load(const Safetensors& content, const std::string& source);

 private:
  int64_t observation_size() const { return spec_.map_size() + spec_.vec_size(); }
  int64_t row_size() const { return 2 * observation_size() + action_size_ + 2; }

  ObservationSpec spec_;
  int64_t action_size_, capacity_;
  int64_t next_ = 0;           // row that is written next
  std::vector<float> values_;  // [size, row_size]: observation, action, next observation, reward,
                               // discount
};

}  // namespace sandwright
