#include "agents/squashed_actor.h"

namespace sandwright {

SquashedActor::SquashedActor(std::shared_ptr<MapEncoder> encoder, int64_t action_size,
                             int64_t hidden, RandomStream& stream)
    : action_size_(action_size),
      encoder_(register_module("encoder", std::move(encoder))),
      layers_(register_module("layers", std::make_shared<Perceptron>(1, encoder_->outputs(), hidden,
                                                                     2 * action_size, stream))) {}

torch::Tensor SquashedActor::Features(const ObservationTensors& observation) {
  const torch::NoGradGuard no_grad;
  return encoder_->Forward(observation);
}

SquashedGaussian SquashedActor::Distribution(const torch::Tensor& features) const {
  return SquashedFromOutputs(layers_->Forward(features).squeeze(0));
}

torch::Tensor SquashedActor::Mean(const ObservationTensors& observation) {
  const torch::NoGradGuard no_grad;
  return torch::tanh(Distribution(Features(observation)).mean).to(torch::kCPU).contiguous();
}

torch::Tensor SquashedActor::Draw(const ObservationTensors& observation,
                                  std::span<RandomStream> streams, int draws) {
  const torch::NoGradGuard no_grad;
  const auto rows = static_cast<int64_t>(streams.size());
  auto noise = torch::empty({rows * draws, action_size_});
  for (int64_t i = 0; i < noise.numel(); ++i)
    noise.data_ptr<float>()[i] =
        static_cast<float>(streams[static_cast<size_t>(i / (draws * action_size_))].Normal());
  SquashedGaussian p = Distribution(Features(observation));
  for (auto* part : {&p.mean, &p.log_std}) *part = part->repeat_interleave(draws, 0);
  return Squash(p, noise.to(p.mean.device())).action.to(torch::kCPU).contiguous();
}

}  // namespace sandwright
