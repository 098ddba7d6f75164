#include "agents/categorical.h"

#include "data/base/error.h"

namespace sandwright {

torch::Tensor CategoricalLogProb(const torch::Tensor& logits, const torch::Tensor& choice) {
  return torch::log_softmax(logits, -1).gather(-1, choice.unsqueeze(-1)).squeeze(-1);
}

torch::Tensor CategoricalEntropy(const torch::Tensor& logits) {
  const auto log_probability = torch::log_softmax(logits, -1);
  return -(log_probability.exp() * log_probability).sum(-1);
}

int SampleCategorical(std::span<const float> probability, RandomStream& stream) {
  SAND_CHECK(!probability.empty());
  double left = stream.Uniform();
  size_t choice = 0;
  for (; choice + 1 < probability.size(); ++choice) {
    left -= probability[choice];
    if (left < 0) break;
  }
  return static_cast<int>(choice);
}

}  // namespace sandwright
