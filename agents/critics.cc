#include "agents/critics.h"

namespace sandwright {

Critics::Critics(std::shared_ptr<MapEncoder> encoder, int64_t members, int64_t action_size,
                 int64_t hidden, int64_t outputs, RandomStream& stream)
    : encoder_(register_module("encoder", std::move(encoder))),
      heads_(register_module(
          "heads", std::make_shared<Perceptron>(members, encoder_->outputs() + action_size, hidden,
                                                outputs, stream))) {}

torch::Tensor Critics::Forward(const ObservationTensors& observation, const torch::Tensor& action) {
  return heads_->Forward(torch::cat({encoder_->Forward(observation), action}, 1));
}

torch::Tensor Critics::ForwardFrozen(const torch::Tensor& features,
                                     const torch::Tensor& action) const {
  return heads_->ForwardFrozen(torch::cat({features, action}, 1));
}

}  // namespace sandwright
