// What every learning algorithm is to the training loop, and what all of them share.
#pragma once

#include <torch/torch.h>

#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "agents/actor.h"
#include "data/base/random.h"
#include "env/safetensors.h"
#include "env/vec_env.h"

namespace sandwright {

// Steps environments that outlive it and learns from them. Configuration, environment and seed fix
// every parameter, bit for bit (one thread count of torch).
class Trainer {
 public:
  virtual ~Trainer() = default;

  // Goes on for a stretch and returns what is worth logging of it, by tag.
  virtual std::map<std::string, double> Advance() = 0;
  virtual int64_t steps() const = 0;  // of environments, so far

  // All environments start new episodes, and what belongs to an episode does (exploration noise),
  // fixed by the seed and the steps so far. Called where a
  // checkpoint is written, so that a run that is resumed there repeats the one that was not.
  virtual void RestartEpisodes() = 0;
  // Everything but the configuration and the environments' episodes, which Load starts anew. Load
  // throws Error naming `source` where the state is another algorithm's or of another size.
  virtual void Save(Safetensors& content) const = 0;
  virtual void Load(const Safetensors& content, const std::string& source) = 0;

  virtual Actor& actor() = 0;  // the policy, as far as it has learnt
};

// rollout/ep_rew_mean, rollout/ep_len_mean, rollout/success_rate and rollout/<metric> of finished
// episodes; none where there are none.
std::map<std::string, double> EpisodeScalars(std::span<const EpisodeSummary> finished);

// To tell another rank of them.
nlohmann::json EpisodesToJson(std::span<const EpisodeSummary> episodes);
std::vector<EpisodeSummary> EpisodesFromJson(const nlohmann::json& json);

// Throws Error (a bug of the environment) where a reward or an observation is not finite.
void CheckFinite(const StepBatch& step);

using Clock = std::chrono::steady_clock;
double SecondsSince(Clock::time_point start);

// What environments are reset by after `steps`: a run that is resumed there starts the episodes of one that went on.
uint64_t EpisodesSeed(uint64_t seed, int64_t steps);

// The learning rate that follows `rate` after an update that moved the policy by `kl`: a third less
// beyond twice the target, a half more below half of it, within 1e-6 and 1e-2 (rl_games, Isaac Gym).
double AdaptedRate(double rate, double kl, double target_kl);

// What a schedule ("constant", or "linear": 0 at total_steps) leaves of its first value after `steps`.
double ShareLeft(const std::string& schedule, int64_t steps, int64_t total_steps);

nlohmann::json StreamToJson(const RandomStream& stream);
RandomStream StreamFromJson(const nlohmann::json& json);
// One stream an environment. FromJson throws Error naming `source` where they are of another number.
nlohmann::json StreamsToJson(std::span<const RandomStream> streams);
void StreamsFromJson(const nlohmann::json& json, const std::string& source,
                     std::span<RandomStream> streams);
// Throws Error naming `source` where the metadata `key` is not there or not JSON.
nlohmann::json ParsedMetadata(const Safetensors& content, const std::string& key,
                              const std::string& source);

// Parameters and buffers of `module` as tensors of their names behind `prefix`.
void SaveWeights(const torch::nn::Module& module, const std::string& prefix, Safetensors& content);
// Throws Error naming `source` and the weights that are missing, not finite or of another shape.
void LoadWeights(const Safetensors& content, const std::string& prefix, const std::string& source,
                 torch::nn::Module& module);

}  // namespace sandwright
