#include "agents/tqc.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "data/base/error.h"

namespace sandwright {

torch::Tensor Truncated(const torch::Tensor& quantiles, int64_t dropped) {
  const int64_t critics = quantiles.size(0), each = quantiles.size(2);
  const auto pool = quantiles.transpose(0, 1).reshape({-1, critics * each});
  return std::get<0>(pool.sort(1)).narrow(1, 0, critics * (each - dropped));
}

torch::Tensor QuantileHuberLoss(const torch::Tensor& quantiles, const torch::Tensor& samples) {
  const auto q = quantiles.detach().to(torch::kCPU).contiguous(),
             y = samples.detach().to(torch::kCPU).contiguous();
  const int64_t rows = q.size(1), each = q.size(2), count = y.size(1);
  auto slope = torch::empty_like(q);
  double sum = 0;
  // The pairs are many and the derivative is short: one loop instead of a dozen tensors of them.
  for (int64_t i = 0; i < q.size(0) * rows; ++i) {
    const float* const sample = y.data_ptr<float>() + i % rows * count;
    for (int64_t m = 0; m < each; ++m) {
      const float value = q.data_ptr<float>()[i * each + m];
      const float level = (static_cast<float>(m) + 0.5f) / static_cast<float>(each);
      float loss = 0, pull = 0;
      for (int64_t k = 0; k < count; ++k) {
        const float error = sample[k] - value, size = std::abs(error);
        const float weight = error < 0 ? 1.0f - level : level;
        loss += weight * (size > 1 ? size - 0.5f : 0.5f * error * error);
        pull += weight * std::min(std::max(error, -1.0f), 1.0f);
      }
      sum += loss;
      slope.data_ptr<float>()[i * each + m] = -pull;
    }
  }
  const double pairs = static_cast<double>(q.numel() * count);
  const auto linear = (quantiles * (slope / pairs).to(quantiles.device())).sum();
  return linear - linear.detach() + sum / pairs;
}

CriticRule TruncatedQuantileCritics(const TqcConfig& config) {
  if (config.dropped >= config.quantiles)
    throw Error(fmt::format("tqc.dropped = {}; allowed: less than tqc.quantiles = {}",
                            config.dropped, config.quantiles));
  return {.critics = config.critics,
          .outputs = config.quantiles,
          .next_value = [dropped = config.dropped](
                            const torch::Tensor& q) { return Truncated(q, dropped); },
          .loss = QuantileHuberLoss,
          // Equation 12: nothing is left out for the actor.
          .value = [](const torch::Tensor& q) { return q.mean(-1).mean(0); }};
}

}  // namespace sandwright
