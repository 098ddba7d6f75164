// How much better than expected each step of a rollout turned out (Schulman et al., "High-dimensional
// continuous control using generalized advantage estimation", ICLR 2016).
#pragma once

#include <torch/torch.h>

#include <cstdint>
#include <span>
#include <vector>

namespace sandwright {

// Advantages and lambda-returns of T steps of N environments, all [T * N], step-major.
struct Advantages {
  std::vector<float> advantage, value_target;
};
// `next_value` is V(s_{t+1}): 0 where the episode terminated, the value of the episode's *final*
// observation where it was truncated. `episode_end` (either) cuts the sum over later steps.
Advantages EstimateAdvantages(std::span<const float> reward, std::span<const float> value,
                              std::span<const float> next_value,
                              std::span<const uint8_t> episode_end, int num_envs, double gamma,
                              double lambda);

// Of mean 0 and deviation 1; where their deviation is below `floor` they are divided by the floor
// instead, so that a critic's noise is not enlarged to a signal. [B] to [B].
torch::Tensor NormalizedAdvantages(const torch::Tensor& advantage, double floor);

// Share of the returns' variance that the values explain: 1 is perfect, below 0 worse than a constant.
double ExplainedVariance(const torch::Tensor& value, const torch::Tensor& target);

}  // namespace sandwright
