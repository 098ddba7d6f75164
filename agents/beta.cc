#include "agents/beta.h"

#include <algorithm>
#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {

// Draws are kept this far off 0 and 1.
constexpr double kMargin = 5e-7;

torch::Tensor LogBetaFunction(const BetaParameters& p) {
  return torch::lgamma(p.alpha) + torch::lgamma(p.beta) - torch::lgamma(p.alpha + p.beta);
}

double SampleGamma(double shape, RandomStream& stream) {
  const double d = shape - 1.0 / 3.0, c = 1.0 / std::sqrt(9.0 * d);
  for (;;) {
    const double x = stream.Normal();
    const double v = std::pow(1.0 + c * x, 3);
    if (v <= 0) continue;
    const double u = 1.0 - stream.Uniform();  // (0, 1]
    if (std::log(u) < 0.5 * x * x + d * (1.0 - v + std::log(v))) return d * v;
  }
}

}  // namespace

BetaParameters BetaFromOutputs(const torch::Tensor& outputs) {
  const auto halves = (torch::softplus(outputs) + 1.0).chunk(2, -1);
  return {halves[0], halves[1]};
}

torch::Tensor BetaLogProb(const BetaParameters& p, const torch::Tensor& action) {
  const auto x = ((action + 1.0) * 0.5).clamp(kMargin, 1.0 - kMargin);
  const auto log_density =
      (p.alpha - 1.0) * torch::log(x) + (p.beta - 1.0) * torch::log1p(-x) - LogBetaFunction(p);
  return (log_density - std::log(2.0)).sum(-1);
}

double BetaLogProb(double alpha, double beta, double action) {
  const double x = std::clamp((action + 1.0) * 0.5, kMargin, 1.0 - kMargin);
  return (alpha - 1.0) * std::log(x) + (beta - 1.0) * std::log1p(-x) - std::lgamma(alpha) -
         std::lgamma(beta) + std::lgamma(alpha + beta) - std::log(2.0);
}

torch::Tensor BetaEntropy(const BetaParameters& p) {
  const auto total = p.alpha + p.beta;
  const auto entropy = LogBetaFunction(p) - (p.alpha - 1.0) * torch::digamma(p.alpha) -
                       (p.beta - 1.0) * torch::digamma(p.beta) +
                       (total - 2.0) * torch::digamma(total);
  return (entropy + std::log(2.0)).sum(-1);
}

torch::Tensor BetaMean(const BetaParameters& p) { return 2.0 * p.alpha / (p.alpha + p.beta) - 1.0; }

float SampleBeta(double alpha, double beta, RandomStream& stream) {
  SAND_CHECK(alpha >= 1 && beta >= 1, alpha, beta);
  const double first = SampleGamma(alpha, stream), second = SampleGamma(beta, stream);
  const double share = std::clamp(first / (first + second), kMargin, 1.0 - kMargin);
  return static_cast<float>(2.0 * share - 1.0);
}

}  // namespace sandwright
