// The shaping environment: N episodes of sand sculpting, stepped together.
#pragma once

#include <functional>
#include <memory>

#include "env/episode.h"
#include "env/observation.h"
#include "env/task_generator.h"
#include "env/vec_env.h"

namespace sandwright {

struct ShapingConfig {
  int64_t num_envs = 32;
  bool random_phase = true;
  EpisodeConfig episode;
  ObservationConfig observation;

  void Fields(FieldList& f) {
    f.Add("num_envs", num_envs, "environments stepped together", 1, 100000);
    f.Add("random_phase", random_phase,
          "first episodes start with a random part of their budget used, so that not all end "
          "together");
    f.Section("episode", episode);
    f.Section("observation", observation);
  }
};

// Draws the task of one episode. Called from several threads at once.
using TaskSource = std::function<std::shared_ptr<const Task>(RandomStream&)>;
// One of a list, each as likely.
TaskSource TasksFrom(std::vector<Task> tasks);
// A new one each time.
TaskSource TasksFrom(const TaskConfig& config);

// When a row whose episode ended starts anew.
enum class Autoreset {
  kSameStep,  // in the step that ended it: what VecEnv::Step promises
  kNextStep,  // in the step after, which ignores its action, is worth 0 and ends nothing
  kDisabled,  // only by Reset; stepping it before throws Error
};

// Episode k of environment i draws its task and its noise from streams of (seed, purpose, i 2^32 +
// k): the same seed gives the same bytes whatever World::threads is.
class ShapingEnv final : public VecEnv {
 public:
  // Everything that changes: restoring it goes on bit for bit, and copies are what-if worlds.
  struct State {
    // Where a row's randomness comes from: (seed, row), and how many episodes it has started.
    struct Source {
      uint64_t seed, row, episodes;
    };
    std::vector<EpisodeState> episodes;  // [N]
    std::vector<Source> sources;         // [N]
  };

  // `world` must outlive the environment. Its rows are first_row and those behind it of a larger one.
  ShapingEnv(const ShapingConfig& config, const World& world, TaskSource tasks,
             Autoreset autoreset = Autoreset::kSameStep, uint64_t first_row = 0);

  int num_envs() const override { return static_cast<int>(config_.num_envs); }
  const ObservationSpec& observation_spec() const override { return spec_; }
  int action_size() const override { return kActionSize; }
  ObservationBatch Reset(uint64_t seed) override;
  // Starts the rows where `chosen` [N] is not 0 anew: with seeds[i] as the only row of Reset(seeds[i])
  // would, without with the next episode of its own. Returns what all rows show.
  ObservationBatch Reset(std::span<const uint8_t> chosen,
                         std::span<const std::optional<uint64_t>> seeds);
  // Each finished episode's summary carries EpisodeMetrics; they are in the order of their rows.
  // final_observation is filled in for Autoreset::kSameStep only.
  StepBatch Step(std::span<const float> action_na) override;

  // What all rows show now.
  ObservationBatch Observe() const;
  // The episodes as they stand [N].
  std::span<const EpisodeState> episodes() const { return state_.episodes; }
  // What the last Step did in each row [N]; none where it started anew instead.
  std::span<const std::optional<StrokeResult>> results() const { return results_; }

  const State& state() const { return state_; }
  // A state of an environment of the same configuration, model and number of rows.
  void Restore(State state);

 private:
  EpisodeState NewEpisode(State::Source& source) const;
  void EncodeInto(int index, ObservationBatch& batch) const;
  ObservationBatch EmptyBatch() const;  // zeros

  ShapingConfig config_;
  World world_;
  TaskSource tasks_;
  Autoreset autoreset_;
  uint64_t first_row_;
  ObservationSpec spec_;
  State state_;
  std::vector<std::optional<StrokeResult>> results_;
};

}  // namespace sandwright
