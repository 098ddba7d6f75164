#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "agents/ppo.h"
#include "agents/tqc.h"
#include "agents/training.h"
#include "data/base/error.h"
#include "data/base/machine.h"
#include "data/base/stop.h"
#include "env/reference/reference_vec_env.h"

namespace sandwright {
namespace {

constexpr const char* kSchema = "sandwright-reference-policy";

class ReferenceTraining final : public Training {
 public:
  ReferenceTraining(const TrainConfig& config, const TrainRun& run)
      : config_(config),
        run_(run),
        device_(SelectDevice(config.device)),
        env_(config.reference, static_cast<int>(config.env.num_envs) / run.ranks->size(), run.threads,
             static_cast<uint64_t>(config.env.num_envs / run.ranks->size() * run.ranks->rank())) {
    if (config.algorithm == "ppo") {
      RandomStream initial(run.seed, StreamId("initial weights"));
      network_ = std::make_unique<ActorCritic>(env_.observation_spec(), env_.action_size(),
                                               config.network, initial, env_.choices());
      trainer_ = std::make_unique<Ppo>(env_, *network_, config.ppo, config.total_steps, run.seed,
                                       device_, *run.ranks);
    } else {
      CriticRule rule =
          config.algorithm == "tqc" ? TruncatedQuantileCritics(config.tqc) : TwinCritics();
      trainer_ = std::make_unique<Sac>(env_, config.sac, std::move(rule), run.seed, device_);
    }
  }

  Trainer& trainer() override { return *trainer_; }

  std::optional<Verdict> Evaluate() override {
    const auto returns = Play();
    if (!returns) return {};
    double sum = 0, squares = 0;
    for (const double value : *returns) sum += value;
    const double mean = sum / static_cast<double>(returns->size());
    for (const double value : *returns) squares += (value - mean) * (value - mean);
    return Verdict{-mean,
                   {{"eval/mean_reward", mean},
                    {"eval/std_reward", std::sqrt(squares / static_cast<double>(returns->size()))}},
                   fmt::format("mean return {:.1f}", mean)};
  }

  nlohmann::json EvaluatedOn() const override {
    return {{"reference", config_.reference}, {"evaluation_tasks", config_.evaluation_tasks}};
  }

  Safetensors Pack() override {
    Safetensors content;
    content.metadata = {{"schema", kSchema},
                        {"schema_version", "1"},
                        {"reference", config_.reference},
                        {"algorithm", config_.algorithm},
                        {"seed", nlohmann::json(run_.seed).dump()},
                        {"steps", nlohmann::json(trainer_->steps()).dump()},
                        {"config", ToJson(FieldsOf(config_)).dump()},
                        {"commit", BuildCommit()}};
    SaveWeights(trainer_->actor(), "network.", content);
    return content;
  }

  void CheckSame(const Safetensors& checkpoint, const std::string& source) const override {
    for (const auto& [key, ours] : std::map<std::string, std::string>{
             {"schema", kSchema}, {"reference", config_.reference}, {"algorithm", config_.algorithm}})
      if (const auto& saved = checkpoint.Metadata(key, source); saved != ours)
        throw Error(fmt::format("{}: {} is '{}'; this run's is '{}'", source, key, saved, ours));
  }

  nlohmann::json Result(const Verdict& last, double least_cost) const override {
    return {{"reference", config_.reference},
            {"algorithm", config_.algorithm},
            {"evaluation_episodes", config_.evaluation_tasks},
            {"mean_reward", last.scalars.at("eval/mean_reward")},
            {"std_reward", last.scalars.at("eval/std_reward")},
            {"mean_reward_best", -least_cost}};
  }

 private:
  // Returns of one episode of each row, all from seeds of their own; none after Ctrl-C.
  std::optional<std::vector<double>> Play() {
    ReferenceVecEnv env(config_.reference, static_cast<int>(config_.evaluation_tasks),
                        run_.threads);
    ObservationBatch observation =
        env.Reset(RandomStream(run_.seed, StreamId("reference evaluation")).Next64());
    std::vector<std::optional<double>> first(static_cast<size_t>(env.num_envs()));
    for (size_t left = first.size(); left > 0;) {
      if (StopRequested()) return {};
      const auto action =
          trainer_->actor().Mean(ToTensors(observation, env.observation_spec(), device_));
      StepBatch step =
          env.Step({action.data_ptr<float>(), static_cast<size_t>(action.numel())});
      auto finished = step.finished.begin();
      for (size_t i = 0; i < first.size(); ++i) {
        if (!step.terminated[i] && !step.truncated[i]) continue;
        if (!first[i]) first[i] = finished->episode_return, --left;
        ++finished;
      }
      observation = std::move(step.observation);
    }
    std::vector<double> returns;
    for (const auto& value : first) returns.push_back(*value);
    return returns;
  }

  TrainConfig config_;
  TrainRun run_;
  torch::Device device_;
  ReferenceVecEnv env_;
  std::unique_ptr<ActorCritic> network_;  // of PPO
  std::unique_ptr<Trainer> trainer_;
};

}  // namespace

std::unique_ptr<Training> MakeReferenceTraining(const TrainConfig& config, const TrainRun& run) {
  if (config.algorithm == "expert_iteration" || config.algorithm == "group_gradient")
    throw Error(fmt::format("algorithm = {} asks the sand model; reference tasks have none: allowed: ppo, sac, tqc",
                            config.algorithm));
  return std::make_unique<ReferenceTraining>(config, run);
}

}  // namespace sandwright
