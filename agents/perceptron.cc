#include "agents/perceptron.h"

#include <cmath>
#include <string>

namespace sandwright {
namespace {

// [B, inputs] through all layers.
torch::Tensor Through(const std::array<torch::Tensor, 3>& weight,
                      const std::array<torch::Tensor, 3>& bias, const torch::Tensor& input) {
  auto values = input.unsqueeze(0).expand({weight[0].size(0), -1, -1});
  for (size_t layer = 0; layer < weight.size(); ++layer) {
    values = torch::baddbmm(bias[layer], values, weight[layer]);
    if (layer + 1 < weight.size()) values = torch::relu_(values);
  }
  return values;
}

}  // namespace

torch::Tensor UniformWithin(double limit, torch::IntArrayRef shape, RandomStream& stream) {
  auto values = torch::empty(shape);
  for (int64_t i = 0; i < values.numel(); ++i)
    values.data_ptr<float>()[i] = static_cast<float>(stream.Uniform(-limit, limit));
  return values;
}

Perceptron::Perceptron(int64_t members, int64_t inputs, int64_t hidden, int64_t outputs,
                       RandomStream& stream) {
  const std::array<int64_t, 4> sizes = {inputs, hidden, hidden, outputs};
  for (size_t layer = 0; layer < weight_.size(); ++layer) {
    const double limit = 1.0 / std::sqrt(static_cast<double>(sizes[layer]));
    const std::string number = std::to_string(layer);
    weight_[layer] = register_parameter(
        "weight" + number, UniformWithin(limit, {members, sizes[layer], sizes[layer + 1]}, stream));
    bias_[layer] =
        register_parameter("bias" + number, UniformWithin(limit, {members, 1, sizes[layer + 1]}, stream));
  }
}

torch::Tensor Perceptron::Forward(const torch::Tensor& input) const {
  return Through(weight_, bias_, input);
}

torch::Tensor Perceptron::ForwardFrozen(const torch::Tensor& input) const {
  auto weight = weight_, bias = bias_;
  for (auto* part : {&weight, &bias})
    for (torch::Tensor& values : *part) values = values.detach();
  return Through(weight, bias, input);
}

}  // namespace sandwright
