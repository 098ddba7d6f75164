// An ensemble that values actions, on what one encoder makes of the observation.
#pragma once

#include "agents/map_encoder.h"
#include "agents/perceptron.h"

namespace sandwright {

class Critics : public torch::nn::Module {
 public:
  Critics(std::shared_ptr<MapEncoder> encoder, int64_t members, int64_t action_size, int64_t hidden,
          int64_t outputs, RandomStream& stream);

  // Of actions [B, A]: [members, B, outputs].
  torch::Tensor Forward(const ObservationTensors& observation, const torch::Tensor& action);
  // The same with gradients for the action alone, of `features` [B, F] that the encoder gave.
  torch::Tensor ForwardFrozen(const torch::Tensor& features, const torch::Tensor& action) const;

 private:
  std::shared_ptr<MapEncoder> encoder_;
  std::shared_ptr<Perceptron> heads_;
};

}  // namespace sandwright
