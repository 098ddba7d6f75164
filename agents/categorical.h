// One of several choices, with probability softmax(logits).
#pragma once

#include <torch/torch.h>

#include <span>

#include "data/base/random.h"

namespace sandwright {

// Log probability of `choice` [B], int64, under `logits` [B, C]: [B].
torch::Tensor CategoricalLogProb(const torch::Tensor& logits, const torch::Tensor& choice);
// [B].
torch::Tensor CategoricalEntropy(const torch::Tensor& logits);

// One draw: an index of `probability`, whose entries sum to 1.
int SampleCategorical(std::span<const float> probability, RandomStream& stream);

}  // namespace sandwright
