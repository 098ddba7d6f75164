// The policy of SAC: a Gaussian of independent numbers, pressed onto (-1, 1) by tanh (Haarnoja et
// al., arXiv 1812.05905, appendix C).
#pragma once

#include <torch/torch.h>

namespace sandwright {

// Before squashing.
struct SquashedGaussian {
  torch::Tensor mean, log_std;  // [B, A]
};

// From raw network outputs [B, 2 A]; the log standard deviation is held within [-20, 2].
SquashedGaussian SquashedFromOutputs(const torch::Tensor& outputs);

struct SquashedDraw {
  torch::Tensor action;    // [B, A] in (-1, 1)
  torch::Tensor log_prob;  // [B], of the action's density
};
// With `noise` [B, A] of the standard normal distribution; gradients reach `p` through both.
SquashedDraw Squash(const SquashedGaussian& p, const torch::Tensor& noise);

}  // namespace sandwright
