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

// Episode k of environment i draws its task and its noise from streams of (seed, purpose, i 2^32 +
// k): the same seed gives the same bytes whatever World::threads is.
class ShapingEnv final : public VecEnv {
 public:
  // `world` must outlive the environment.
  ShapingEnv(const ShapingConfig& config, const World& world, TaskSource tasks);

  int num_envs() const override { return static_cast<int>(config_.num_envs); }
  const ObservationSpec& observation_spec() const override { return spec_; }
  int action_size() const override { return kActionSize; }
  ObservationBatch Reset(uint64_t seed) override;
  // Each finished episode's summary carries EpisodeMetrics.
  StepBatch Step(std::span<const float> action_na) override;

  // The episodes as they stand [N].
  std::span<const EpisodeState> episodes() const { return episodes_; }

 private:
  EpisodeState NewEpisode(int index, uint64_t number) const;
  void EncodeInto(int index, ObservationBatch& batch) const;
  ObservationBatch EmptyBatch() const;  // zeros

  ShapingConfig config_;
  World world_;
  TaskSource tasks_;
  ObservationSpec spec_;
  uint64_t seed_ = 0;
  std::vector<EpisodeState> episodes_;
  std::vector<uint64_t> episode_number_;  // [N] episodes started so far
};

}  // namespace sandwright
