// Perceptrons of one shape side by side, computed as one: an actor, or all critics of an ensemble.
#pragma once

#include <torch/torch.h>

#include <array>

#include "data/base/random.h"

namespace sandwright {

// The first weights of a layer: uniform within +-`limit`, drawn from `stream`.
torch::Tensor UniformWithin(double limit, torch::IntArrayRef shape, RandomStream& stream);

// Two hidden layers of rectified linear units.
class Perceptron : public torch::nn::Module {
 public:
  // Weights and biases are uniform within +-1 / sqrt(inputs of their layer), drawn from `stream`.
  Perceptron(int64_t members, int64_t inputs, int64_t hidden, int64_t outputs,
             RandomStream& stream);

  // [B, inputs] to [members, B, outputs].
  torch::Tensor Forward(const torch::Tensor& input) const;
  // The same, with gradients for the input alone.
  torch::Tensor ForwardFrozen(const torch::Tensor& input) const;

 private:
  std::array<torch::Tensor, 3> weight_;  // [members, inputs, outputs] of each layer
  std::array<torch::Tensor, 3> bias_;    // [members, 1, outputs]
};

}  // namespace sandwright
