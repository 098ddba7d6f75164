// What every policy is: a network that acts on what it sees.
#pragma once

#include <span>

#include "agents/tensors.h"
#include "data/base/random.h"

namespace sandwright {

class Actor : public torch::nn::Module {
 public:
  // The deterministic action [B, A], on the CPU and contiguous; no gradients.
  virtual torch::Tensor Mean(const ObservationTensors& observation) = 0;
  // `draws` actions a row, one after the other, drawn with streams[row]: [B * draws, A] alike.
  virtual torch::Tensor Draw(const ObservationTensors& observation, std::span<RandomStream> streams,
                             int draws) = 0;
};

}  // namespace sandwright
