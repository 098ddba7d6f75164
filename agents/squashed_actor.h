// The policy of SAC and TQC as a network: an encoder, two layers, a squashed Gaussian.
#pragma once

#include <memory>

#include "agents/actor.h"
#include "agents/map_encoder.h"
#include "agents/perceptron.h"
#include "agents/squashed_gaussian.h"

namespace sandwright {

class SquashedActor final : public Actor {
 public:
  SquashedActor(std::shared_ptr<MapEncoder> encoder, int64_t action_size, int64_t hidden,
                RandomStream& stream);

  // What the encoder makes of an observation [B, F]; no gradients, as it is the critics that teach it.
  torch::Tensor Features(const ObservationTensors& observation);
  // With gradients for the actor's own layers.
  SquashedGaussian Distribution(const torch::Tensor& features) const;
  std::vector<torch::Tensor> OwnParameters() const { return layers_->parameters(); }

  torch::Tensor Mean(const ObservationTensors& observation) override;
  torch::Tensor Draw(const ObservationTensors& observation, std::span<RandomStream> streams,
                     int draws) override;

 private:
  int64_t action_size_;
  std::shared_ptr<MapEncoder> encoder_;
  std::shared_ptr<Perceptron> layers_;
};

}  // namespace sandwright
