#include "agents/train.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <optional>

#include "agents/evaluate.h"
#include "env/load_gate.h"
#include "agents/policy_agent.h"
#include "agents/run_log.h"
#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/machine.h"
#include "data/base/progress.h"
#include "data/base/stop.h"
#include "env/load_sand_model.h"

namespace sandwright {
namespace {

// Tasks that choose the best parameters: neither trained on nor those that `eval` reports.
constexpr uint64_t kValidationTasks = StreamId("validation task");
static_assert(kValidationTasks != kTrainingTasks && kValidationTasks != kEvaluationTasks);

constexpr size_t kKeptCheckpoints = 3;

std::vector<std::filesystem::path> Checkpoints(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code missing;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "checkpoints", missing))
    if (entry.path().extension() == ".safetensors" &&
        !entry.path().filename().string().starts_with("."))
      files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

void MakeFolders(const std::filesystem::path& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder / "checkpoints", failure);
  if (failure) throw Error("cannot make folder " + folder.string() + ": " + failure.message());
}

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

// One run from its first to its last update.
class Run {
 public:
  Run(const TrainConfig& config, const TrainRun& run)
      : config_(config),
        run_(run),
        device_(SelectDevice(config.device)),
        sand_(LoadSandModel(config.model, config.sand)),
        gate_(LoadGate(config.workcell)),
        world_{*sand_, gate_.get(), run.threads},
        env_(config.env, world_, TrainingTasks(config)),
        initial_(run.seed, StreamId("initial weights")),
        network_(env_.observation_spec(), env_.action_size(), config.network, initial_),
        validation_(ValidationTasks(config, run.seed)),
        ppo_(env_, network_, config.ppo, config.total_steps, run.seed, device_) {
    card_.network = config.network;
    card_.observation = config.env.observation;
    const EpisodeConfig& episode = config.env.episode;
    card_.region_width_m =
        episode.region_width_m > 0 ? episode.region_width_m : validation_[0].goal.width_m();
    card_.region_depth_m =
        episode.region_depth_m > 0 ? episode.region_depth_m : validation_[0].goal.depth_m();
    card_.seed = run.seed;
    card_.config = ToJson(FieldsOf(config_));
  }

  void Resume(const Safetensors& content, const std::string& source) {
    const Policy saved = UnpackPolicy(content, source, device_);
    const torch::NoGradGuard no_grad;
    const auto from = saved.network->parameters(), to = network_.parameters();
    SAND_CHECK(from.size() == to.size());
    for (size_t i = 0; i < from.size(); ++i) {
      if (from[i].sizes() != to[i].sizes()) throw Error(source + ": saved with another network");
      to[i].copy_(from[i]);
    }
    ppo_.Load(content, source);
    // The best so far counts only where it was measured on the same.
    if (content.Metadata("validated_on", source) == ValidatedOn())
      best_mm_ = nlohmann::json::parse(content.Metadata("best_mm", source));
  }

  nlohmann::json Go() {
    WriteFileAtomically(run_.folder / "config.yaml",
                        fmt::format("# train --seed {}, version {} ({})\n{}", run_.seed,
                                    BuildVersion(), BuildCommit(), ToYaml(FieldsOf(config_))));
    RunLog log(run_.folder, ppo_.steps());
    Progress progress("train", config_.total_steps, "strokes");
    progress.Update(ppo_.steps());
    while (ppo_.steps() < config_.total_steps) {
      const int64_t before = ppo_.steps();
      const PpoReport report = ppo_.Update();
      auto scalars = ScalarsOf(report, ppo_.steps() - before);
      const bool last = ppo_.steps() >= config_.total_steps;
      if (last || Passed(before, config_.evaluate_every)) scalars.merge(Validate());
      log.Write(ppo_.steps(), scalars);
      progress.Update(ppo_.steps(), Note(scalars));
      const bool stop = StopRequested();
      if (last || stop || Passed(before, config_.checkpoint_every)) {
        WriteCheckpoint();
        ppo_.RestartEpisodes();
      }
      if (stop && !last)
        throw Error(fmt::format("stopped after {} strokes; continue with --resume {}", ppo_.steps(),
                                run_.folder.string()),
                    ErrorKind::kInterrupted);
    }
    WriteSafetensors(Pack(), run_.folder / "agent.safetensors");
    return {{"steps", ppo_.steps()},
            {"seconds", progress.elapsed_s()},
            {"seed", run_.seed},
            {"device", torch::DeviceTypeName(device_.type(), true)},
            {"validation_in_goal_mean_diff_start_mm", start_mm_},
            {"validation_in_goal_mean_diff_mm", last_mm_},
            {"validation_in_goal_mean_diff_best_mm", best_mm_}};
  }

 private:
  // A multiple of `every` lies in (before, steps].
  bool Passed(int64_t before, int64_t every) const {
    return every > 0 && before / every != ppo_.steps() / every;
  }

  std::map<std::string, double> Validate() {
    PolicyAgent agent("policy", card_, network_, device_);
    const Evaluation result = Evaluate(agent, world_, config_.env.episode, validation_, run_.seed);
    if (result.stopped) return {};  // half-played tasks tell nothing; a checkpoint comes next
    start_mm_ = result.Mean("in_goal_mean_diff_start_mm");
    last_mm_ = result.Mean("in_goal_mean_diff_mm");
    if (last_mm_ < best_mm_) {
      best_mm_ = last_mm_;
      WriteSafetensors(Pack(), run_.folder / "best.safetensors");
    }
    return {{"eval/in_goal_mean_diff_start_mm", start_mm_},
            {"eval/in_goal_mean_diff_mm", last_mm_},
            {"eval/success_rate", result.Mean("success")}};
  }

  // The part of the configuration that a validation error depends on.
  std::string ValidatedOn() const {
    nlohmann::json on;
    for (const char* key : {"model", "workcell", "heightfield", "task", "env", "evaluation_tasks"})
      on[key] = card_.config.at(key);
    return on.dump();
  }

  Safetensors Pack() {
    card_.steps = ppo_.steps();
    return PackPolicy(network_, card_);
  }

  void WriteCheckpoint() {
    Safetensors content = Pack();
    ppo_.Save(content);
    content.metadata["best_mm"] = nlohmann::json(best_mm_).dump();
    content.metadata["validated_on"] = ValidatedOn();
    WriteSafetensors(content,
                     run_.folder / "checkpoints" / fmt::format("{:012}.safetensors", ppo_.steps()));
    const auto files = Checkpoints(run_.folder);
    for (size_t i = 0; i + kKeptCheckpoints < files.size(); ++i) std::filesystem::remove(files[i]);
  }

  static std::string Note(const std::map<std::string, double>& scalars) {
    std::string note;
    if (const auto found = scalars.find("rollout/ep_rew_mean"); found != scalars.end())
      note = fmt::format("return {:.2f}", found->second);
    if (const auto found = scalars.find("eval/in_goal_mean_diff_mm"); found != scalars.end())
      note += fmt::format(", goal error {:.2f} -> {:.2f} mm",
                          scalars.at("eval/in_goal_mean_diff_start_mm"), found->second);
    return note;
  }

  TrainConfig config_;
  TrainRun run_;
  torch::Device device_;
  std::unique_ptr<const SandModel> sand_;
  std::unique_ptr<const SafetyGate> gate_;
  World world_;
  ShapingEnv env_;
  RandomStream initial_;
  ActorCritic network_;
  std::vector<Task> validation_;
  Ppo ppo_;
  PolicyCard card_;
  double start_mm_ = 0, last_mm_ = 0, best_mm_ = std::numeric_limits<double>::max();
};

}  // namespace

std::filesystem::path LastCheckpoint(const std::filesystem::path& folder) {
  const auto files = Checkpoints(folder);
  if (files.empty()) throw Error(folder.string() + ": no checkpoint to resume from");
  return files.back();
}

nlohmann::json Train(TrainConfig config, TrainRun run) {
  torch::set_num_threads(static_cast<int>(config.torch_threads));
  std::optional<Safetensors> content;
  std::string source;
  if (run.resume) {
    source = LastCheckpoint(run.folder).string();
    content = ReadSafetensors(source);
    run.seed = nlohmann::json::parse(content->Metadata("seed", source));
  }
  MakeFolders(run.folder);
  Run training(config, run);
  if (content) training.Resume(*content, source);
  return training.Go();
}

}  // namespace sandwright
