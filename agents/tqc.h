// Truncated quantile critics (Kuznetsov et al., arXiv 2005.04269): SAC whose critics give quantiles
// of the return. The target leaves out the greatest, where errors would be believed.
#pragma once

#include "agents/sac.h"

namespace sandwright {

// Throws Error where no quantile would be left.
CriticRule TruncatedQuantileCritics(const TqcConfig& config);

// The samples of a target [B, critics (quantiles - dropped)]: all quantiles [critics, B, quantiles]
// in one pool, less the greatest `dropped` a critic (equation 7).
torch::Tensor Truncated(const torch::Tensor& quantiles, int64_t dropped);

// Equation 10, the Huber quantile loss of each quantile [critics, B, M] against each sample [B, K],
// averaged over all pairs. Gradients reach `quantiles`.
torch::Tensor QuantileHuberLoss(const torch::Tensor& quantiles, const torch::Tensor& samples);

}  // namespace sandwright
