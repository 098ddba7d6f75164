// An observation to a vector of features: its map through three strided convolutions, its numbers as they are.
#pragma once

#include <torch/torch.h>

#include "agents/tensors.h"
#include "data/base/random.h"

namespace sandwright {

class MapEncoder : public torch::nn::Module {
 public:
  // `channels` at half the map's resolution, twice as many at a quarter and an eighth, then `features`,
  // layer-normalised and within +-1 (as in Yarats et al., ICLR 2022). Weights and biases are uniform within
  // +-1 / sqrt(inputs of their layer), drawn from `stream`. Without a map there is nothing to learn.
  MapEncoder(const ObservationSpec& spec, int64_t channels, int64_t features, RandomStream& stream);

  int64_t outputs() const { return outputs_; }
  torch::Tensor Forward(const ObservationTensors& observation);  // [B, outputs]

 private:
  int64_t outputs_;
  torch::nn::Sequential convolutions_{nullptr}, head_{nullptr};
};

}  // namespace sandwright
