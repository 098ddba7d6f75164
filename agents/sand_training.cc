#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <opencv2/core.hpp>

#include "agents/evaluate.h"
#include "agents/expert_iteration.h"
#include "agents/group_gradient.h"
#include "agents/policy_agent.h"
#include "agents/ppo.h"
#include "agents/symmetry.h"
#include "agents/tqc.h"
#include "agents/training.h"
#include "data/base/error.h"
#include "env/load_gate.h"
#include "env/load_sand_model.h"

namespace sandwright {
namespace {

// Tasks that choose the best parameters: neither trained on nor those that `eval` reports.
constexpr uint64_t kValidationTasks = StreamId("validation task");
static_assert(kValidationTasks != kTrainingTasks && kValidationTasks != kEvaluationTasks);

std::vector<Task> ValidationTasks(const TrainConfig& config, uint64_t seed) {
  std::vector<Task> tasks;
  for (int64_t i = 0; i < config.evaluation_tasks; ++i) {
    RandomStream stream(seed, kValidationTasks, static_cast<uint64_t>(i));
    tasks.push_back(GenerateTask(config.task, stream));
  }
  return tasks;
}

TaskSource TrainingTasks(const TrainConfig& config) {
  return config.tasks_file.empty() ? TasksFrom(config.task)
                                   : TasksFrom(ReadTasks(config.tasks_file));
}

ShapingConfig ShareOf(ShapingConfig config, const Collective& ranks) {
  config.num_envs /= ranks.size();
  return config;
}

uint64_t FirstRow(const ShapingConfig& config, const Collective& ranks) {
  return static_cast<uint64_t>(config.num_envs / ranks.size() * ranks.rank());
}

class SandTraining final : public Training {
 public:
  SandTraining(const TrainConfig& config, const TrainRun& run)
      : config_(config),
        seed_(run.seed),
        device_(SelectDevice(config.device)),
        sand_(LoadSandModel(config.model, config.sand)),
        gate_(LoadGate(config.workcell)),
        world_{*sand_, gate_.get(), run.threads},
        env_(ShareOf(config.env, *run.ranks), world_, TrainingTasks(config), Autoreset::kSameStep,
             FirstRow(config.env, *run.ranks)),
        validation_(ValidationTasks(config, run.seed)) {
    if (config.algorithm == "sac" || config.algorithm == "tqc")
      MakeSac(run.seed);
    else
      MakeActorCritic(run);
    card_.observation = config.env.observation;
    const EpisodeConfig& episode = config.env.episode;
    card_.region_width_m =
        episode.region_width_m > 0 ? episode.region_width_m : validation_[0].goal.width_m();
    card_.region_depth_m =
        episode.region_depth_m > 0 ? episode.region_depth_m : validation_[0].goal.depth_m();
    card_.seed = run.seed;
    card_.config = ToJson(FieldsOf(config_));
  }

  Trainer& trainer() override { return *trainer_; }

  std::optional<Verdict> Evaluate() override {
    PolicyAgent agent("policy", card_, trainer_->actor(), device_);
    const Evaluation result =
        sandwright::Evaluate(agent, world_, config_.env.episode, validation_, seed_);
    if (result.stopped) return {};
    const double start_mm = result.Mean("in_goal_mean_diff_start_mm"),
                 end_mm = result.Mean("in_goal_mean_diff_mm");
    constexpr size_t kShown = 4;
    std::vector<cv::Mat> rows;
    for (size_t i = 0; i < std::min(kShown, validation_.size()); ++i)
      rows.push_back(DrawTask(validation_[i], result.end[i]));
    cv::Mat picture;
    cv::vconcat(rows, picture);
    return Verdict{end_mm,
                   {{"eval/in_goal_mean_diff_start_mm", start_mm},
                    {"eval/in_goal_mean_diff_mm", end_mm},
                    {"eval/success_rate", result.Mean("success")}},
                   fmt::format("goal error {:.2f} -> {:.2f} mm", start_mm, end_mm), picture};
  }

  nlohmann::json EvaluatedOn() const override {
    nlohmann::json on;
    for (const char* key : {"model", "workcell", "heightfield", "task", "env", "evaluation_tasks"})
      on[key] = card_.config.at(key);
    return on;
  }

  Safetensors Pack() override {
    card_.steps = trainer_->steps();
    return PackPolicy(trainer_->actor(), card_);
  }

  void CheckSame(const Safetensors& checkpoint, const std::string& source) const override {
    UnpackPolicy(checkpoint, source, torch::kCPU);
  }

  nlohmann::json Result(const Verdict& last, double least_cost) const override {
    return {{"validation_in_goal_mean_diff_start_mm",
             last.scalars.at("eval/in_goal_mean_diff_start_mm")},
            {"validation_in_goal_mean_diff_mm", last.cost},
            {"validation_in_goal_mean_diff_best_mm", least_cost}};
  }

 private:
  void MakeActorCritic(const TrainRun& run) {
    RandomStream initial(run.seed, StreamId("initial weights"));
    network_ = std::make_unique<ActorCritic>(env_.observation_spec(), env_.action_size(),
                                             config_.network, initial);
    card_.network = config_.network;
    if (!config_.initial_policy.empty())
      LoadPolicyWeights(ReadSafetensors(config_.initial_policy), config_.initial_policy, *network_);
    const EpisodeConfig& episode = config_.env.episode;
    if (config_.algorithm == "ppo")
      trainer_ = std::make_unique<Ppo>(env_, *network_, config_.ppo, config_.total_steps, run.seed,
                                       device_, *run.ranks);
    else if (config_.algorithm == "group_gradient")
      trainer_ = std::make_unique<GroupGradient>(env_, world_, episode, *network_, config_.group,
                                                 config_.total_steps, run.seed, device_);
    else
      trainer_ = std::make_unique<ExpertIteration>(env_, world_, episode, *network_, config_.expert,
                                                   config_.total_steps, run.seed, device_);
  }

  void MakeSac(uint64_t seed) {
    if (!config_.initial_policy.empty())
      throw Error(fmt::format("initial_policy = {}: algorithm = {} starts anew; allowed: empty",
                              config_.initial_policy, config_.algorithm));
    CriticRule rule =
        config_.algorithm == "tqc" ? TruncatedQuantileCritics(config_.tqc) : TwinCritics();
    const int symmetries =
        config_.sac.symmetry ? SymmetriesOf(env_.observation_spec(), env_.episodes()[0].region) : 1;
    trainer_ = std::make_unique<Sac>(env_, config_.sac, std::move(rule), seed, device_, symmetries);
    card_.network = config_.sac.network;
  }

  TrainConfig config_;
  uint64_t seed_;
  torch::Device device_;
  std::unique_ptr<const SandModel> sand_;
  std::unique_ptr<const SafetyGate> gate_;
  World world_;
  ShapingEnv env_;
  std::vector<Task> validation_;
  std::unique_ptr<ActorCritic> network_;  // not of SAC and TQC, which have their own
  std::unique_ptr<Trainer> trainer_;
  PolicyCard card_;
};

}  // namespace

std::unique_ptr<Training> MakeSandTraining(const TrainConfig& config, const TrainRun& run) {
  return std::make_unique<SandTraining>(config, run);
}

}  // namespace sandwright
