#include "agents/map_encoder.h"

#include <cmath>

#include "agents/perceptron.h"

namespace sandwright {
namespace {

namespace nn = torch::nn;

template <class Layer>
Layer Initialised(Layer layer, RandomStream& stream) {
  const int64_t inputs = layer->weight.numel() / layer->weight.size(0);
  const double limit = 1.0 / std::sqrt(static_cast<double>(inputs));
  const torch::NoGradGuard no_grad;
  for (torch::Tensor* values : {&layer->weight, &layer->bias})
    values->copy_(UniformWithin(limit, values->sizes(), stream));
  return layer;
}

nn::Conv2d Halving(int64_t in, int64_t out, RandomStream& stream) {
  return Initialised(nn::Conv2d(nn::Conv2dOptions(in, out, 3).stride(2).padding(1)), stream);
}

}  // namespace

MapEncoder::MapEncoder(const ObservationSpec& spec, int64_t channels, int64_t features,
                       RandomStream& stream)
    : outputs_(spec.vec_size()) {
  if (spec.map_size() == 0) return;
  const auto eighth = [](int64_t size) { return (size + 7) / 8; };
  // One after the other: the order of the draws is not left to the compiler.
  const auto half = Halving(std::ssize(spec.channels), channels, stream);
  const auto quarter = Halving(channels, 2 * channels, stream);
  const auto last = Halving(2 * channels, 2 * channels, stream);
  convolutions_ = register_module(
      "convolutions",
      nn::Sequential(half, nn::ReLU(), quarter, nn::ReLU(), last, nn::ReLU(), nn::Flatten()));
  head_ = register_module(
      "head",
      nn::Sequential(
          Initialised(nn::Linear(2 * channels * eighth(spec.rows) * eighth(spec.columns), features),
                      stream),
          nn::LayerNorm(nn::LayerNormOptions({features})), nn::Tanh()));
  outputs_ += features;
}

torch::Tensor MapEncoder::Forward(const ObservationTensors& observation) {
  if (!head_) return observation.vec;
  // Channels last: convolutions of few channels take half the time.
  const auto map = observation.map.contiguous(torch::MemoryFormat::ChannelsLast);
  return torch::cat({head_->forward(convolutions_->forward(map)), observation.vec}, 1);
}

}  // namespace sandwright
