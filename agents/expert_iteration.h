// Expert iteration (Anthony, Tian, Barber, "Thinking fast and slow with deep learning and tree
// search", NeurIPS 2017): an expert that tries many strokes on the sand model teaches the policy, and
// the better policy gives the expert better strokes to try. The expert here looks one stroke ahead,
// from the true sand; the policy sees what the sensor shows.
#pragma once

#include "agents/advice_buffer.h"
#include "agents/expert_config.h"
#include "agents/flat_adam.h"
#include "agents/networks.h"
#include "agents/trainer.h"
#include "env/shaping_env.h"

namespace sandwright {

class ExpertIteration final : public Trainer {
 public:
  // The references must outlive it; `world` and `episode` are those of `env`. The seed fixes every
  // draw.
  ExpertIteration(ShapingEnv& env, const World& world, const EpisodeConfig& episode,
                  ActorCritic& network, const ExpertConfig& config, int64_t total_steps,
                  uint64_t seed, torch::Device device);

  // One round: num_steps strokes of each environment, then gradient_steps.
  std::map<std::string, double> Advance() override;
  int64_t steps() const override { return steps_; }

  void RestartEpisodes() override;
  void Save(Safetensors& content) const override;
  void Load(const Safetensors& content, const std::string& source) override;
  Actor& actor() override { return network_; }

 private:
  // The best strokes of one state, best first, with what they are worth; those that the gate refuses
  // are not among them.
  struct Advice {
    std::vector<Action> action;
    std::vector<double> reward;
  };
  Advice Ask(const EpisodeState& state, std::span<const Action> from_policy, RandomStream& stream);
  // Tries `candidates` and puts them into `advice`.
  void Try(const EpisodeState& state, std::span<const Action> candidates, Advice& advice);
  double Learn();  // one gradient step; returns the loss

  ShapingEnv& env_;
  World world_;
  EpisodeConfig episode_;
  ActorCritic& network_;
  ExpertConfig config_;
  int64_t total_steps_, steps_ = 0;
  uint64_t seed_;
  torch::Device device_;
  FlatAdam optimizer_;
  std::vector<RandomStream> streams_;  // one an environment
  RandomStream shuffle_stream_;
  ObservationBatch observation_;
  AdviceBuffer buffer_;
};

}  // namespace sandwright
