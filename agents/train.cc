#include "agents/train.h"

#include <malloc.h>
#include <spdlog/fmt/fmt.h>

#include <limits>
#include <optional>

#include "agents/networks.h"
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
      : config_(config), run_(run), training_(training), trainer_(training.trainer()) {}

  void Resume(const Safetensors& content, const std::string& source) {
    training_.CheckSame(content, source);
    trainer_.Load(content, source);
    // The best so far counts only where it was measured on the same.
    if (content.Metadata("evaluated_on", source) == training_.EvaluatedOn().dump())
      least_cost_ = ParsedMetadata(content, "least_cost", source);
  }

  nlohmann::json Go() {
    // Before the configuration, which makes it a run: whatever has one can be resumed.
    if (!run_.resume) WriteCheckpoint(Checkpoint(), 0, run_.folder);
    WriteFileAtomically(run_.folder / "config.yaml",
                        fmt::format("# train --seed {}, version {} ({})\n{}", run_.seed,
                                    BuildVersion(), BuildCommit(), ToYaml(FieldsOf(config_))));
    const std::string unit = config_.OnSand() ? "strokes" : "steps";
    RunLog log(run_.folder, trainer_.steps());
    Progress progress("train", config_.total_steps, unit, run_.status);
    progress.Update(trainer_.steps());
    while (trainer_.steps() < config_.total_steps) {
      const int64_t before = trainer_.steps();
      auto scalars = trainer_.Advance();
      std::string note;
      if (const auto found = scalars.find("rollout/ep_rew_mean"); found != scalars.end())
        note = fmt::format("return {:.2f}", found->second);
      const bool last = trainer_.steps() >= config_.total_steps;
      if (last || Passed(before, config_.evaluate_every)) note += Evaluate(scalars);
      log.Write(trainer_.steps(), scalars);
      if (verdict_ && !verdict_->picture.empty())
        log.WritePicture(trainer_.steps(), "eval/tasks", std::exchange(verdict_->picture, {}));
      if (run_.status) run_.status->Figures(scalars);
      progress.Update(trainer_.steps(), note);
      const bool stop = StopRequested();
      if (last || stop || Passed(before, config_.checkpoint_every)) {
        WriteCheckpoint(Checkpoint(), trainer_.steps(), run_.folder);
        trainer_.RestartEpisodes();
      }
      if (stop && !last)
        throw Error(fmt::format("stopped after {} {}; continue with --resume {}", trainer_.steps(),
                                unit, run_.folder.string()),
                    ErrorKind::kInterrupted);
    }
    WriteSafetensors(training_.Pack(), run_.folder / "agent.safetensors");
    nlohmann::json result = {{"steps", trainer_.steps()},
                             {"seconds", progress.elapsed_s()},
                             {"evaluation_seconds", evaluation_s_},
                             {"seed", run_.seed},
                             {"device", torch::DeviceTypeName(SelectDevice(config_.device).type(), true)}};
    if (verdict_) result.update(training_.Result(*verdict_, least_cost_));
    return result;
  }

 private:
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
      WriteSafetensors(training_.Pack(), run_.folder / "best.safetensors");
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
  std::optional<Verdict> verdict_;
  double least_cost_ = std::numeric_limits<double>::max();
  double evaluation_s_ = 0;
};

}  // namespace

nlohmann::json Train(TrainConfig config, TrainRun run) {
  KeepFreedMemory();
  torch::set_num_threads(static_cast<int>(config.torch_threads));
  std::optional<Safetensors> content;
  std::string source;
  if (run.resume) {
    source = LastCheckpoint(run.folder).string();
    content = ReadSafetensors(source);
    run.seed = ParsedMetadata(*content, "seed", source);
  }
  const auto training =
      config.OnSand() ? MakeSandTraining(config, run) : MakeReferenceTraining(config, run);
  MakeRunFolder(run.folder);
  Run going(config, run, *training);
  if (content) going.Resume(*content, source);
  return going.Go();
}

}  // namespace sandwright
