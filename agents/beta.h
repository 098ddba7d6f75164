// The Beta distribution on a bounded action: no probability is lost beyond the bounds, unlike with
// a clipped Gaussian (Chou, Maturana, Scherer, "Improving stochastic policy gradients in continuous
// control with deep RL using the Beta distribution", ICML 2017).
//
// Actions live on [-1, 1]; the density there is half of Beta's on [0, 1].
#pragma once

#include <torch/torch.h>

#include "data/base/random.h"

namespace sandwright {

// Both concentrations are above 1: the density has one peak and vanishes at the bounds.
struct BetaParameters {
  torch::Tensor alpha, beta;  // [B, A]
};

// From raw network outputs [B, 2 A]: softplus + 1.
BetaParameters BetaFromOutputs(const torch::Tensor& outputs);

// Log density of `action` [B, A] in (-1, 1), summed over A: [B].
torch::Tensor BetaLogProb(const BetaParameters& p, const torch::Tensor& action);
// The same of one number.
double BetaLogProb(double alpha, double beta, double action);
// Differential entropy, summed over A: [B].
torch::Tensor BetaEntropy(const BetaParameters& p);
// Mean action [B, A].
torch::Tensor BetaMean(const BetaParameters& p);

// One draw on [-1, 1] (the ratio of two Gamma draws; Marsaglia and Tsang, ACM TOMS 26, 2000, valid
// for concentrations of 1 and more), kept 1e-6 off the bounds, where the log density diverges.
float SampleBeta(double alpha, double beta, RandomStream& stream);

}  // namespace sandwright
