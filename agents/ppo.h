// Proximal policy optimisation (Schulman et al., arXiv 1707.06347) with generalised advantage
// estimation (Schulman et al., ICLR 2016) over a batch of environments, which may be spread over
// several ranks: all hold the same parameters and each differentiates the rows of its environments.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "agents/advantages.h"
#include "agents/collective.h"
#include "agents/flat_adam.h"
#include "agents/networks.h"
#include "agents/ppo_config.h"
#include "agents/return_scaler.h"
#include "agents/trainer.h"

namespace sandwright {

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
  // `env`, `network` and `ranks` must outlive it. The seed fixes action noise, shuffling and episodes.
  // `env` has as many rows on every rank, those behind the rows of the ranks before.
  Ppo(VecEnv& env, ActorCritic& network, const PpoConfig& config, int64_t total_steps,
      uint64_t seed, torch::Device device, Collective& ranks = Alone());

  // One rollout of num_steps steps of all ranks' environments, then the epochs over it.
  PpoReport Update();
  // An update's report by tag: train/..., time/fps, time/rollout_s, time/update_s and EpisodeScalars.
  std::map<std::string, double> Advance() override;
  int64_t steps() const override { return steps_; }

  void RestartEpisodes() override;
  void Save(Safetensors& content) const override;
  void Load(const Safetensors& content, const std::string& source) override;
  Actor& actor() override { return network_; }

 private:
  struct Rollout {  // of this rank's environments
    ObservationTensors observation;         // [T * N, ...]
    torch::Tensor action, log_prob, value;  // [T * N, A], [T * N], [T * N]
    torch::Tensor advantage, value_target;  // [T * N]

    // What `choose` makes of every tensor.
    Rollout Map(const std::function<torch::Tensor(const torch::Tensor&)>& choose) const;
  };
  struct Collected {
    Rollout rollout;
    torch::Tensor advantage;  // of all ranks' environments [T * ranks * N]
  };
  Collected Collect(PpoReport& report);
  // The epochs; returns how many gradient steps they were.
  int64_t Learn(const Collected& collected, PpoReport& report);
  // One gradient step on a minibatch, of which `rows` are this rank's `share`, with advantages that
  // are normalised; returns the KL estimate.
  double Step(const Rollout& rows, double share, PpoReport& report);
  // The gradient of the loss, times `share`, and the loss's terms as they are reported.
  std::array<float, 5> Differentiate(const Rollout& rows, double share, double clip);
  std::vector<int64_t> Permutation(int64_t count);
  // Takes in the rewards of all ranks' environments.
  void ObserveReturns(std::span<const float> reward, std::span<const uint8_t> ends);
  // What happened in the other ranks' environments, and where their noise goes on from.
  void ShareEpisodes(PpoReport& report);
  // The numbers [T * N, V] of all ranks' environments.
  torch::Tensor OfAllRanks(const torch::Tensor& numbers);
  std::span<RandomStream> OwnStreams();

  Collective& ranks_;
  VecEnv& env_;
  ActorCritic& network_;
  PpoConfig config_;
  int64_t total_steps_, steps_ = 0;
  uint64_t seed_;
  torch::Device device_;
  FlatAdam optimizer_;
  std::vector<RandomStream> action_streams_;  // one an environment of all ranks
  RandomStream shuffle_stream_;
  double adapted_rate_ = config_.learning_rate;  // of the adaptive schedule
  ReturnScaler return_scaler_;
  ObservationBatch observation_;
};

}  // namespace sandwright
