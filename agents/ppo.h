// Proximal policy optimisation (Schulman et al., arXiv 1707.06347) with generalised advantage
// estimation (Schulman et al., ICLR 2016) over a batch of environments.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "agents/flat_adam.h"
#include "agents/networks.h"
#include "agents/ppo_config.h"
#include "agents/return_scaler.h"
#include "agents/trainer.h"

namespace sandwright {

// Advantages and lambda-returns of T steps of N environments, all [T * N], step-major.
struct Advantages {
  std::vector<float> advantage, value_target;
};
// `next_value` is V(s_{t+1}): 0 where the episode terminated, the value of the episode's *final*
// observation where it was truncated. `episode_end` (either) cuts the sum over later steps.
Advantages EstimateAdvantages(std::span<const float> reward, std::span<const float> value,
                              std::span<const float> next_value,
                              std::span<const uint8_t> episode_end, int num_envs, double gamma,
                              double lambda);

// Of mean 0 and deviation 1; where their deviation is below `floor` they are divided by the floor
// instead, so that a critic's noise is not enlarged to a signal. [B] to [B].
torch::Tensor NormalizedAdvantages(const torch::Tensor& advantage, double floor);

// What one update did.
struct PpoReport {
  double policy_loss = 0, value_loss = 0, entropy = 0, approx_kl = 0, clip_fraction = 0;
  double explained_variance = 0, gradient_norm = 0, learning_rate = 0, clip_range = 0;
  double advantage_deviation = 0, advantage_floor = 0;  // before normalising; and its least divisor
  double rollout_s = 0, update_s = 0;
  int64_t epochs = 0;                    // started, fewer than asked where target_kl stopped them
  std::vector<EpisodeSummary> finished;  // episodes that ended in the rollout
};

class Ppo final : public Trainer {
 public:
  // `env` and `network` must outlive it. The seed fixes action noise, shuffling and episodes.
  Ppo(VecEnv& env, ActorCritic& network, const PpoConfig& config, int64_t total_steps,
      uint64_t seed, torch::Device device);

  // One rollout of num_steps * num_envs steps, then the epochs over it.
  PpoReport Update();
  // An update's report by tag: train/..., time/fps, time/rollout_s, time/update_s and EpisodeScalars.
  std::map<std::string, double> Advance() override;
  int64_t steps() const override { return steps_; }

  void RestartEpisodes() override;
  void Save(Safetensors& content) const override;
  void Load(const Safetensors& content, const std::string& source) override;
  torch::Tensor Mean(const ObservationBatch& observation) override;
  const torch::nn::Module& network() const override { return network_; }

 private:
  struct Rollout {
    ObservationTensors observation;         // [T * N, ...]
    torch::Tensor action, log_prob, value;  // [T * N, A], [T * N], [T * N]
    torch::Tensor advantage, value_target;  // [T * N]

    // What `choose` makes of every tensor.
    Rollout Map(const std::function<torch::Tensor(const torch::Tensor&)>& choose) const;
  };
  Rollout Collect(PpoReport& report);
  // One gradient step on a minibatch; returns the KL estimate.
  double Step(const Rollout& rows, PpoReport& report);
  torch::Tensor Permutation(int64_t count);

  VecEnv& env_;
  ActorCritic& network_;
  PpoConfig config_;
  int64_t total_steps_, steps_ = 0;
  uint64_t seed_;
  torch::Device device_;
  FlatAdam optimizer_;
  std::vector<RandomStream> action_streams_;  // one an environment
  RandomStream shuffle_stream_;
  double adapted_rate_ = config_.learning_rate;  // of the adaptive schedule
  ReturnScaler return_scaler_;
  ObservationBatch observation_;
};

}  // namespace sandwright
