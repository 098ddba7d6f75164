// Soft actor-critic with a learnt temperature (Haarnoja et al., arXiv 1812.05905), for actions that are
// numbers. What a map shows is learnt by the critics alone; the actor reads it from them (Yarats et al.,
// ICLR 2022).
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "agents/critics.h"
#include "agents/flat_adam.h"
#include "agents/n_step.h"
#include "agents/replay_buffer.h"
#include "agents/sac_config.h"
#include "agents/squashed_actor.h"
#include "agents/trainer.h"

namespace sandwright {

// What distinguishes SAC from TQC: how the outputs [critics, B, outputs] of an ensemble are read.
struct CriticRule {
  int64_t critics, outputs;
  // Samples of the next state's value [B, K], from the target critics.
  std::function<torch::Tensor(const torch::Tensor&)> next_value;
  // The critics' loss against samples of the return [B, K].
  std::function<torch::Tensor(const torch::Tensor&, const torch::Tensor&)> loss;
  // What the actor maximises [B].
  std::function<torch::Tensor(const torch::Tensor&)> value;
};

// The lesser of two (Fujimoto et al., ICML 2018), for target and actor.
CriticRule TwinCritics();

class Sac final : public Trainer {
 public:
  // `symmetries`: how many the environment has (symmetry.h), of which each batch is shown one; 1: none. Throws
  // Error where the action is a choice.
  Sac(VecEnv& env, const SacConfig& config, CriticRule rule, uint64_t seed, torch::Device device,
      int symmetries = 1);

  std::map<std::string, double> Advance() override;
  int64_t steps() const override { return rounds_ * env_.num_envs(); }
  void RestartEpisodes() override;
  void Save(Safetensors& content) const override;
  void Load(const Safetensors& content, const std::string& source) override;
  Actor& actor() override { return actor_; }

 private:
  // Sums over the gradient steps of a stretch.
  struct Sums {
    double critic_loss = 0, actor_loss = 0, entropy = 0;
    int64_t gradient_steps = 0;
  };
  // Exploration of one environment: its own stream, and the noise of the coming steps.
  struct Noise {
    RandomStream stream;
    std::vector<std::vector<float>> series;  // [A][kNoiseLength]
    size_t used;
  };

  // One action for each environment [N, A].
  torch::Tensor Explore();
  void Renew(Noise& noise) const;
  void GradientStep(Sums& sums);
  Transitions Replay();
  SquashedDraw DrawFresh(const torch::Tensor& features);
  // By `share` of the way to the critics.
  void MoveTargets(double share);
  double temperature() const;

  VecEnv& env_;
  SacConfig config_;
  CriticRule rule_;
  uint64_t seed_;
  torch::Device device_;
  int symmetries_;
  int64_t rounds_ = 0;  // steps of each environment
  RandomStream initial_stream_, replay_stream_, policy_stream_;
  std::vector<Noise> noises_;  // one an environment
  std::shared_ptr<MapEncoder> encoder_;  // of actor and critics
  SquashedActor actor_;
  Critics critics_, targets_;
  torch::Tensor log_temperature_;  // [1]
  FlatAdam actor_adam_, critic_adam_, temperature_adam_;
  NStep n_step_;
  ReplayBuffer replay_;
  ObservationBatch observation_;
};

}  // namespace sandwright
