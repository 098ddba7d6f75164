#include "agents/observation_normalizer.h"

#include <algorithm>
#include <cmath>

namespace sandwright {
namespace {
constexpr float kFarthest = 10, kLeastVariance = 1e-8f;
}  // namespace

ObservationNormalizer::ObservationNormalizer(int64_t size)
    : count_(register_buffer("count", torch::zeros({1}))),
      mean_(register_buffer("mean", torch::zeros({size}))),
      variance_(register_buffer("variance", torch::ones({size}))) {}

void ObservationNormalizer::Observe(const torch::Tensor& rows) {
  const torch::NoGradGuard no_grad;
  const auto wide = rows.to(torch::kFloat64);
  const auto seen = count_.to(torch::kFloat64);
  const double fresh = static_cast<double>(rows.size(0));
  const auto all = seen + fresh;
  const auto shift = wide.mean(0) - mean_;
  const auto squares = variance_ * seen + wide.var(0, /*unbiased=*/false) * fresh +
                       shift.square() * seen * fresh / all;
  mean_.add_(shift * fresh / all);
  variance_.copy_(squares / all);
  count_.copy_(all);
}

torch::Tensor ObservationNormalizer::Forward(const torch::Tensor& rows) const {
  return ((rows - mean_) / (variance_ + kLeastVariance).sqrt()).clamp(-kFarthest, kFarthest);
}

void ObservationNormalizer::ForwardRow(std::span<float> row) const {
  const float *const mean = mean_.data_ptr<float>(), *const variance = variance_.data_ptr<float>();
  for (size_t i = 0; i < row.size(); ++i)
    row[i] = std::clamp((row[i] - mean[i]) / std::sqrt(variance[i] + kLeastVariance), -kFarthest,
                        kFarthest);
}

}  // namespace sandwright
