#include "agents/squashed_gaussian.h"

#include <cmath>
#include <numbers>

namespace sandwright {
namespace {
constexpr double kLeastLogStd = -20, kGreatestLogStd = 2;
}  // namespace

SquashedGaussian SquashedFromOutputs(const torch::Tensor& outputs) {
  const auto halves = outputs.chunk(2, -1);
  return {halves[0], halves[1].clamp(kLeastLogStd, kGreatestLogStd)};
}

SquashedDraw Squash(const SquashedGaussian& p, const torch::Tensor& noise) {
  const auto raw = p.mean + p.log_std.exp() * noise;
  // Equation 26 with log(1 - tanh(u)^2) = 2 (log 2 - u - softplus(-2 u)), exact where tanh is 1 in
  // float, too.
  const auto log_gaussian =
      -0.5 * noise.square() - p.log_std - 0.5 * std::log(2.0 * std::numbers::pi);
  const auto log_slope = 2.0 * (std::numbers::ln2 - raw - torch::softplus(-2.0 * raw));
  return {torch::tanh(raw), (log_gaussian - log_slope).sum(-1)};
}

}  // namespace sandwright
