// The last transitions of all environments, drawn from evenly.
#pragma once

#include <span>
#include <string>

#include "agents/row_ring.h"
#include "agents/tensors.h"

namespace sandwright {

// B transitions on one device.
struct Transitions {
  ObservationTensors observation;
  torch::Tensor action;  // [B, A]
  ObservationTensors next_observation;
  torch::Tensor reward, discount;  // [B, 1]; discount: of the value of what followed, 0 where the episode terminated
};

class ReplayBuffer {
 public:
  // Of the last `capacity` transitions.
  ReplayBuffer(const ObservationSpec& spec, int64_t action_size, int64_t capacity);

  // Observations: the map, then the numbers.
  void Add(std::span<const float> observation, std::span<const float> action,
           std::span<const float> next_observation, float reward, float discount);
  int64_t size() const { return rows_.size(); }

  // Independent draws; size() > 0.
  Transitions Sample(int64_t count, RandomStream& stream, torch::Device device) const;

  void Save(Safetensors& content) const { rows_.Save(content); }
  void Load(const Safetensors& content, const std::string& source) { rows_.Load(content, source); }

 private:
  ObservationSpec spec_;
  int64_t action_size_;
  RowRing rows_;  // observation, action, next observation, reward, discount
};

}  // namespace sandwright
