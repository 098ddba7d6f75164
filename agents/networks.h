// The actor-critic network: an observation to a distribution of actions and a value.
//
// With a map (the sand): a small convolutional pyramid gives features for each place of the map. The
// bin of a stroke's start and heading is drawn from a grid over them (stroke_place.h), where in the
// bin they lie and the rest of the stroke (length, depths, bend) from Beta distributions whose
// parameters are read at the chosen bin. Without a map (reference tasks): two perceptrons of two hidden tanh layers, as in the PPO
// paper; a Beta distribution a number of the action, or one probability a choice.
#pragma once

#include <torch/torch.h>

#include <span>

#include "agents/actor.h"
#include "agents/beta.h"
#include "agents/network_config.h"
#include "agents/observation_normalizer.h"
#include "agents/stroke_place.h"
#include "data/base/random.h"

namespace sandwright {

class ActorCritic final : public Actor {
 public:
  struct Decision {
    torch::Tensor action, log_prob, value;  // [B, A], [B], [B] on the CPU, no gradients
  };
  struct Terms {
    torch::Tensor log_prob, entropy;  // [B * draws]
    torch::Tensor value;              // [B]
  };

  // Orthogonal initial weights drawn from `stream`: the policy starts near uniform over places (or
  // choices), and the rest near config.first_guess. Error where that has another length than the
  // rest. `choices` as VecEnv::choices(), without a map only.
  ActorCritic(const ObservationSpec& spec, int action_size, const NetworkConfig& config,
              RandomStream& stream, int choices = 0);

  // `draws` actions a row (1 without a map), one after the other, drawn with streams[row]. A few rows
  // without a map are computed without torch (plain_layers.h), to within 1e-6 of what it gives (log
  // densities 1e-5).
  Decision Sample(const ObservationTensors& observation, std::span<RandomStream> streams,
                  int draws = 1);
  // The most probable bin and the means of the numbers there, or the most probable choice.
  torch::Tensor Mean(const ObservationTensors& observation) override;
  torch::Tensor Draw(const ObservationTensors& observation, std::span<RandomStream> streams,
                     int draws) override {
    return Sample(observation, streams, draws).action;
  }
  torch::Tensor Value(const ObservationTensors& observation);
  // For the update: how probable `action` [B * draws, A] is, with gradients; with a map as many consecutive
  // rows an observation as Sample draws. The entropy of the Beta part is that at the given action's place, a
  // one-sample estimate of its mean.
  Terms Evaluate(const ObservationTensors& observation, const torch::Tensor& action);
  // Where config.normalize asks for it: takes the observation's numbers into the running mean and
  // variance that everything above brings them to.
  void Observe(const ObservationTensors& observation);

 private:
  // Adds residual bottlenecks (He et al., CVPR 2016) over the places, dilated by 1, 2, 4, 1, ... (Yu, Koltun,
  // ICLR 2016): a stroke is judged along its way. Each starts as the identity.
  void AddBlocks(const NetworkConfig& config, RandomStream& stream);
  // Lets the first policy prefer surplus sand: adds place_skip_, through which what the map shows
  // at a place goes straight into its logits.
  void PreferSurplus(const ObservationSpec& spec, const NetworkConfig& config);
  // Sets the first Beta means of the rest of the action.
  void GuessFirst(const std::vector<double>& means);
  struct Encoding {
    torch::Tensor places;  // [B, F, rows, columns]; undefined without a map
    torch::Tensor whole;   // [B, hidden]
    torch::Tensor worth;   // [B, hidden]: what the value is read from
  };
  Encoding Encode(const ObservationTensors& observation);
  torch::Tensor PlaceLogits(const Encoding& encoding, const torch::Tensor& map);
  Decision SampleChoice(const Encoding& encoding, std::span<RandomStream> streams);
  Decision SamplePlaces(const Encoding& encoding, const torch::Tensor& map,
                        std::span<RandomStream> streams, int draws);
  // Of all numbers of the action, the first three within their bin, read at `bin` [M] of the
  // encoding's rows `row` [M].
  BetaParameters NumbersAt(const Encoding& encoding, const torch::Tensor& row,
                           const torch::Tensor& bin);
  // `action` [B, A] with its first three numbers within `bin` [B].
  torch::Tensor Offsets(const torch::Tensor& action, const torch::Tensor& bin) const;
  // Its inverse: the action [B, A] of `offsets` within `bin`.
  torch::Tensor ActionAt(const torch::Tensor& bin, const torch::Tensor& offsets) const;
  // Sample without torch, of numbers [B, V] on the CPU.
  Decision SamplePlainly(const torch::Tensor& numbers, std::span<RandomStream> streams);
  torch::Tensor ValueOf(const Encoding& encoding);

  bool has_map_;
  int action_size_, choices_;
  PlaceGrid grid_;
  torch::Tensor coordinates_;  // [1, 2, H, W]: x and y on [-1, 1]
  torch::nn::Conv2d fine_{nullptr}, middle_{nullptr}, coarse_{nullptr};
  torch::nn::Conv2d fine_mix_{nullptr}, middle_mix_{nullptr}, coarse_mix_{nullptr};
  struct Block {
    torch::nn::Conv2d narrow{nullptr}, look{nullptr}, widen{nullptr};
  };
  std::vector<Block> blocks_;
  torch::nn::Conv2d place_head_{nullptr}, place_skip_{nullptr};
  torch::nn::Linear whole_in_{nullptr}, whole_out_{nullptr}, whole_mix_{nullptr};
  torch::nn::Linear rest_hidden_{nullptr}, rest_head_{nullptr};
  torch::nn::Linear value_in_{nullptr}, value_hidden_{nullptr}, value_head_{nullptr};
  std::shared_ptr<ObservationNormalizer> normalizer_;
};

}  // namespace sandwright
