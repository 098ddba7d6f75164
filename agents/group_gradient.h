// A policy gradient whose baseline is the group: in each state many strokes are drawn from the policy, the sand
// model tries them all, and each is learnt by how it compares with the others (GRPO: Shao et al., "DeepSeekMath",
// 2024; clipped as PPO's). No value is learnt and nothing looks further than one stroke. With `seek`, the group's
// advantage is that of a risk-seeking utility (Howard, Matheson, Management Science 18(7), 1972): the policy is
// drawn to where its best strokes are before it has learnt to hit there.
#pragma once

#include "agents/flat_adam.h"
#include "agents/group_config.h"
#include "agents/networks.h"
#include "agents/trainer.h"
#include "env/shaping_env.h"

namespace sandwright {

// Of rewards [B, K], a group a row: standardised, or with seek > 0 the standardised softmax of (reward in
// deviations of its group / seek). Rows of equal rewards: 0. Adding to a row, or scaling it, changes nothing.
torch::Tensor GroupAdvantages(const torch::Tensor& reward, double seek);

class GroupGradient final : public Trainer {
 public:
  // The references must outlive it; `world` and `episode` are those of `env`. The seed fixes every draw.
  GroupGradient(ShapingEnv& env, const World& world, const EpisodeConfig& episode, ActorCritic& network,
                const GroupConfig& config, int64_t total_steps, uint64_t seed, torch::Device device);

  // One round: num_steps strokes of each environment, then gradient_steps.
  std::map<std::string, double> Advance() override;
  int64_t steps() const override { return steps_; }

  void RestartEpisodes() override;
  void Save(Safetensors& content) const override;
  void Load(const Safetensors& content, const std::string& source) override;
  Actor& actor() override { return network_; }

 private:
  // N states, each with its K strokes.
  struct Round {
    torch::Tensor map, vec;                     // [N, ...]
    torch::Tensor action, log_prob, advantage;  // [N, K, 7], [N, K], [N, K]
  };
  struct Report {
    double loss = 0, kl = 0, clip_fraction = 0, entropy = 0;
  };
  // What each stroke in `actions` is worth in `state`, the gate's refusal included.
  std::vector<float> Rewards(const EpisodeState& state, std::span<const Action> actions) const;
  Report Learn(const Round& round);  // one gradient step

  ShapingEnv& env_;
  World world_;
  EpisodeConfig episode_;
  ActorCritic& network_;
  GroupConfig config_;
  int64_t total_steps_, steps_ = 0;
  uint64_t seed_;
  torch::Device device_;
  FlatAdam optimizer_;
  std::vector<RandomStream> streams_;  // one an environment
  RandomStream shuffle_stream_;
  ObservationBatch observation_;
};

}  // namespace sandwright
