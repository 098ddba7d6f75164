#include "agents/train.h"

#include <malloc.h>
#include <spdlog/fmt/fmt.h>

#include <limits>
#include <optional>

#include "agents/rank_guard.h"
#include "agents/run_folder.h"
#include "agents/run_log.h"
#include "agents/training.h"
#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/machine.h"
#include "data/base/progress.h"
#include "data/base/stop.h"

namespace sandwright {
namespace {

// A gradient step asks for the same blocks of up to megabytes again and again, which glibc hands back
// to the kernel each time: a seventh of SAC's time went into fresh pages.
void KeepFreedMemory() {
#ifdef __GLIBC__
  constexpr int kLargest_bytes = 256 << 20;
  mallopt(M_MMAP_THRESHOLD, kLargest_bytes);
  mallopt(M_TRIM_THRESHOLD, kLargest_bytes);
#endif
}

// One run from its first to its last update.
class Run {
 public:
  Run(const TrainConfig& config, const TrainRun& run, Training& training)
      : config_(config),
        run_(run),
        training_(training),
        trainer_(training.trainer()),
        guard_(*run.ranks, run.folder) {}

  void Resume(const Safetensors& content, const std::string& source) {
    training_.CheckSame(content, source);
    trainer_.Load(content, source);
    // The best so far counts only where it was measured on the same.
    if (content.Metadata("evaluated_on", source) == training_.EvaluatedOn().dump())
      least_cost_ = ParsedMetadata(content, "least_cost", source);
  }

  nlohmann::json Go() {
    if (leads()) Begin();
    Keep();
    while (trainer_.steps() < config_.total_steps) {
      try {
        Advance();
      } catch (const Error& e) {
        guard_.Rescue(e);
      }
    }
    if (leads()) WriteSafetensors(training_.Pack(), run_.folder / "agent.safetensors");
    nlohmann::json result = {{"steps", trainer_.steps()},
                             {"seconds", SecondsSince(start_)},
                             {"evaluation_seconds", evaluation_s_},
                             {"seed", run_.seed},
                             {"device", torch::DeviceTypeName(SelectDevice(config_.device).type(), true)},
                             {"ranks", run_.ranks->size()}};
    if (verdict_) result.update(training_.Result(*verdict_, least_cost_));
    return result;
  }

 private:
  bool leads() const { return run_.ranks->leads(); }

  void Begin() {
    // Before the configuration, which makes it a run: whatever has one can be resumed.
    if (!run_.resume) WriteCheckpoint(Checkpoint(), 0, run_.folder);
    WriteFileAtomically(run_.folder / "config.yaml",
                        fmt::format("# train --seed {}, version {} ({})\n{}", run_.seed,
                                    BuildVersion(), BuildCommit(), ToYaml(FieldsOf(config_))));
    log_.emplace(run_.folder, trainer_.steps());
    progress_.emplace("train", config_.total_steps, unit(), run_.status);
    progress_->Update(trainer_.steps());
  }

  // One update and what is due after it.
  void Advance() {
    const int64_t before = trainer_.steps();
    auto scalars = trainer_.Advance();
    Keep();
    std::string note;
    if (const auto found = scalars.find("rollout/ep_rew_mean"); found != scalars.end())
      note = fmt::format("return {:.2f}", found->second);
    const bool last = trainer_.steps() >= config_.total_steps;
    if (last || Passed(before, config_.evaluate_every)) note += Evaluate(scalars);
    run_.ranks->CheckIn();
    if (leads()) Tell(scalars, note);
    const bool stop = run_.ranks->size() == 1 && StopRequested();
    if (last || stop || Passed(before, config_.checkpoint_every)) {
      if (leads()) WriteCheckpoint(Checkpoint(), trainer_.steps(), run_.folder);
      trainer_.RestartEpisodes();
    }
    if (stop && !last)
      throw Error(fmt::format("stopped after {} {}; continue with --resume {}", trainer_.steps(),
                              unit(), run_.folder.string()),
                  ErrorKind::kInterrupted);
  }

  void Keep() {
    if (run_.ranks->size() > 1) guard_.Keep(Checkpoint(), trainer_.steps());
  }

  void Tell(const std::map<std::string, double>& scalars, const std::string& note) {
    log_->Write(trainer_.steps(), scalars);
    if (verdict_ && !verdict_->picture.empty())
      log_->WritePicture(trainer_.steps(), "eval/tasks", std::exchange(verdict_->picture, {}));
    if (run_.status) run_.status->Figures(scalars);
    progress_->Update(trainer_.steps(), note);
  }

  std::string unit() const { return config_.OnSand() ? "strokes" : "steps"; }

  // A multiple of `every` lies in (before, steps].
  bool Passed(int64_t before, int64_t every) const {
    return every > 0 && before / every != trainer_.steps() / every;
  }

  // Adds to `scalars`; returns what to tell.
  std::string Evaluate(std::map<std::string, double>& scalars) {
    const auto start = Clock::now();
    const std::optional<Verdict> verdict = training_.Evaluate();
    evaluation_s_ += SecondsSince(start);
    if (!verdict) return "";
    verdict_ = verdict;
    if (verdict->cost < least_cost_) {
      least_cost_ = verdict->cost;
      if (leads()) WriteSafetensors(training_.Pack(), run_.folder / "best.safetensors");
    }
    scalars.insert(verdict->scalars.begin(), verdict->scalars.end());
    return ", " + verdict->note;
  }

  Safetensors Checkpoint() {
    Safetensors content = training_.Pack();
    trainer_.Save(content);
    content.metadata["least_cost"] = nlohmann::json(least_cost_).dump();
    content.metadata["evaluated_on"] = training_.EvaluatedOn().dump();
    return content;
  }

  TrainConfig config_;
  TrainRun run_;
  Training& training_;
  Trainer& trainer_;
  RankGuard guard_;
  std::optional<RunLog> log_;         // of the leader
  std::optional<Progress> progress_;  // of the leader
  Clock::time_point start_ = Clock::now();
  std::optional<Verdict> verdict_;
  double least_cost_ = std::numeric_limits<double>::max();
  double evaluation_s_ = 0;
};

// Throws Error where the run cannot be spread over so many ranks.
void CheckRanks(const TrainConfig& config, int ranks) {
  if (ranks == 1) return;
  if (config.algorithm != "ppo")
    throw Error(fmt::format("algorithm = {} on {} ranks; allowed: ppo", config.algorithm, ranks));
  if (config.env.num_envs % ranks != 0)
    throw Error(fmt::format("env.num_envs = {} on {} ranks; allowed: a multiple of {}",
                            config.env.num_envs, ranks, ranks));
}

// What all ranks must have been started with.
std::map<std::string, std::string> StartOf(TrainConfig config, const TrainRun& run) {
  std::map<std::string, std::string> start = {{"--seed", fmt::format("{}", run.seed)},
                                              {"the program's commit", BuildCommit()}};
  const nlohmann::json keys = ToJson(FieldsOf(config)).flatten();
  for (const auto& [key, value] : keys.items()) start[key.substr(1)] = value.dump();
  return start;
}

}  // namespace

nlohmann::json Train(TrainConfig config, TrainRun run) {
  KeepFreedMemory();
  torch::set_num_threads(static_cast<int>(config.torch_threads));
  std::unique_ptr<Training> training;
  std::unique_ptr<Run> going;
  AllOrNone(*run.ranks, [&] {
    CheckRanks(config, run.ranks->size());
    std::optional<Safetensors> content;
    std::string source;
    if (run.resume) {
      source = LastCheckpoint(run.folder).string();
      content = ReadSafetensors(source);
      run.seed = ParsedMetadata(*content, "seed", source);
    }
    training = config.OnSand() ? MakeSandTraining(config, run) : MakeReferenceTraining(config, run);
    if (run.ranks->leads()) MakeRunFolder(run.folder);
    going = std::make_unique<Run>(config, run, *training);
    if (content) going->Resume(*content, source);
  });
  CheckAlike(*run.ranks, StartOf(config, run), "at the start");
  return going->Go();
}

}  // namespace sandwright
