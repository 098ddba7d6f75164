#include "agents/advantages.h"

#include "data/base/error.h"

namespace sandwright {

Advantages EstimateAdvantages(std::span<const float> reward, std::span<const float> value,
                              std::span<const float> next_value,
                              std::span<const uint8_t> episode_end, int num_envs, double gamma,
                              double lambda) {
  const size_t count = reward.size(), envs = static_cast<size_t>(num_envs);
  SAND_CHECK(value.size() == count && next_value.size() == count && episode_end.size() == count);
  Advantages out{std::vector<float>(count), std::vector<float>(count)};
  for (size_t env = 0; env < envs; ++env) {
    double later = 0;  // the advantage of the next step
    for (size_t t = count / envs; t-- > 0;) {
      const size_t i = t * envs + env;
      const double delta = reward[i] + gamma * next_value[i] - value[i];
      later = delta + (episode_end[i] ? 0.0 : gamma * lambda * later);
      out.advantage[i] = static_cast<float>(later);
      out.value_target[i] = static_cast<float>(later + value[i]);
    }
  }
  return out;
}

torch::Tensor NormalizedAdvantages(const torch::Tensor& advantage, double floor) {
  return (advantage - advantage.mean()) / (advantage.std() + 1e-8).clamp_min(floor);
}

double ExplainedVariance(const torch::Tensor& value, const torch::Tensor& target) {
  const double variance = target.var().item<double>();
  return variance > 0 ? 1.0 - (target - value).var().item<double>() / variance : 0.0;
}

}  // namespace sandwright
