#include "env/shaping_env.h"

#include <algorithm>

#include "data/base/parallel.h"

namespace sandwright {

TaskSource TasksFrom(std::vector<Task> tasks) {
  SAND_CHECK(!tasks.empty());
  std::vector<std::shared_ptr<const Task>> shared;
  for (Task& task : tasks) shared.push_back(std::make_shared<const Task>(std::move(task)));
  return [shared](RandomStream& stream) { return shared[stream.Index(shared.size())]; };
}

TaskSource TasksFrom(const TaskConfig& config) {
  return [config](RandomStream& stream) {
    return std::make_shared<const Task>(GenerateTask(config, stream));
  };
}

ShapingEnv::ShapingEnv(const ShapingConfig& config, const World& world, TaskSource tasks)
    : config_(config), world_(world), tasks_(std::move(tasks)), spec_(SpecOf(config.observation)) {
  Reset(0);
}

EpisodeState ShapingEnv::NewEpisode(int index, uint64_t number) const {
  const uint64_t id = (static_cast<uint64_t>(index) << 32) + number;
  RandomStream task_stream(seed_, kTrainingTasks, id);
  const RandomStream noise(seed_, StreamId("sensor noise"), id);
  std::shared_ptr<const Task> task = tasks_(task_stream);
  const int used =
      config_.random_phase && number == 0
          ? static_cast<int>(task_stream.Index(static_cast<uint64_t>(task->max_strokes)))
          : 0;
  return StartEpisode(world_.sand, std::move(task), config_.episode, noise, used);
}

void ShapingEnv::EncodeInto(int index, ObservationBatch& batch) const {
  Encode(View(episodes_[static_cast<size_t>(index)]), config_.observation,
         batch.map.data() + static_cast<std::ptrdiff_t>(index) * spec_.map_size(),
         batch.vec.data() + static_cast<std::ptrdiff_t>(index) * spec_.vec_size());
}

ObservationBatch ShapingEnv::EmptyBatch() const {
  const auto n = static_cast<size_t>(num_envs());
  return {std::vector<float>(n * static_cast<size_t>(spec_.map_size())),
          std::vector<float>(n * static_cast<size_t>(spec_.vec_size()))};
}

ObservationBatch ShapingEnv::Reset(uint64_t seed) {
  seed_ = seed;
  const auto n = static_cast<size_t>(num_envs());
  std::vector<std::optional<EpisodeState>> fresh(n);
  ParallelFor(num_envs(), world_.threads,
              [&](int i) { fresh[static_cast<size_t>(i)] = NewEpisode(i, 0); });
  episodes_.clear();
  for (auto& episode : fresh) episodes_.push_back(std::move(*episode));
  episode_number_.assign(n, 1);

  ObservationBatch observation = EmptyBatch();
  ParallelFor(num_envs(), world_.threads, [&](int i) { EncodeInto(i, observation); });
  return observation;
}

StepBatch ShapingEnv::Step(std::span<const float> action_na) {
  const auto n = static_cast<size_t>(num_envs());
  SAND_CHECK(action_na.size() == n * kActionSize, action_na.size(), n);
  std::vector<Action> actions(n);
  for (size_t i = 0; i < n; ++i)
    std::copy_n(action_na.begin() + static_cast<std::ptrdiff_t>(i * kActionSize), kActionSize,
                actions[i].begin());
  const auto results = StepEpisodes(world_, config_.episode, episodes_, actions);

  StepBatch batch;
  batch.observation = EmptyBatch();
  batch.final_observation = EmptyBatch();
  for (size_t i = 0; i < n; ++i) {
    const EpisodeState& episode = episodes_[i];
    batch.reward.push_back(static_cast<float>(results[i]->reward.total()));
    batch.terminated.push_back(episode.terminated);
    batch.truncated.push_back(episode.truncated);
    if (episode.ended())
      batch.finished.push_back(
          {episode.episode_return, episode.strokes(), EpisodeMetrics(episode, config_.episode)});
  }
  ParallelFor(num_envs(), world_.threads, [&](int index) {
    const auto i = static_cast<size_t>(index);
    if (episodes_[i].ended()) {
      EncodeInto(index, batch.final_observation);
      episodes_[i] = NewEpisode(index, episode_number_[i]++);
    }
    EncodeInto(index, batch.observation);
  });
  return batch;
}

}  // namespace sandwright
