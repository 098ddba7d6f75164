#include "env/shaping_env.h"

#include <spdlog/fmt/fmt.h>

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

ShapingEnv::ShapingEnv(const ShapingConfig& config, const World& world, TaskSource tasks,
                       Autoreset autoreset, uint64_t first_row)
    : config_(config),
      world_(world),
      tasks_(std::move(tasks)),
      autoreset_(autoreset),
      first_row_(first_row),
      spec_(SpecOf(config.observation)) {
  Reset(0);
}

EpisodeState ShapingEnv::NewEpisode(State::Source& source) const {
  const uint64_t number = source.episodes++, id = (source.row << 32) + number;
  RandomStream task_stream(source.seed, kTrainingTasks, id);
  const RandomStream noise(source.seed, StreamId("sensor noise"), id);
  std::shared_ptr<const Task> task = tasks_(task_stream);
  const int used =
      config_.random_phase && number == 0
          ? static_cast<int>(task_stream.Index(static_cast<uint64_t>(task->max_strokes)))
          : 0;
  return StartEpisode(world_.sand, std::move(task), config_.episode, noise, used);
}

void ShapingEnv::EncodeInto(int index, ObservationBatch& batch) const {
  Encode(View(state_.episodes[static_cast<size_t>(index)], world_.gate), config_.observation,
         batch.map.data() + static_cast<std::ptrdiff_t>(index) * spec_.map_size(),
         batch.vec.data() + static_cast<std::ptrdiff_t>(index) * spec_.vec_size());
}

ObservationBatch ShapingEnv::EmptyBatch() const {
  const auto n = static_cast<size_t>(num_envs());
  return {std::vector<float>(n * static_cast<size_t>(spec_.map_size())),
          std::vector<float>(n * static_cast<size_t>(spec_.vec_size()))};
}

ObservationBatch ShapingEnv::Observe() const {
  ObservationBatch observation = EmptyBatch();
  ParallelFor(num_envs(), world_.threads, [&](int i) { EncodeInto(i, observation); });
  return observation;
}

ObservationBatch ShapingEnv::Reset(uint64_t seed) {
  const auto n = static_cast<size_t>(num_envs());
  std::vector<State::Source> sources;
  for (size_t i = 0; i < n; ++i) sources.push_back({seed, first_row_ + i, 0});
  std::vector<std::optional<EpisodeState>> fresh(n);
  ParallelFor(num_envs(), world_.threads, [&](int index) {
    const auto i = static_cast<size_t>(index);
    fresh[i] = NewEpisode(sources[i]);
  });
  state_ = {{}, std::move(sources)};
  for (auto& episode : fresh) state_.episodes.push_back(std::move(*episode));
  results_.assign(n, std::nullopt);
  return Observe();
}

ObservationBatch ShapingEnv::Reset(std::span<const uint8_t> chosen,
                                   std::span<const std::optional<uint64_t>> seeds) {
  const auto n = static_cast<size_t>(num_envs());
  SAND_CHECK(chosen.size() == n && seeds.size() == n, chosen.size(), seeds.size(), n);
  ParallelFor(num_envs(), world_.threads, [&](int index) {
    const auto i = static_cast<size_t>(index);
    if (!chosen[i]) return;
    if (seeds[i]) state_.sources[i] = {*seeds[i], 0, 0};
    state_.episodes[i] = NewEpisode(state_.sources[i]);
    results_[i].reset();
  });
  return Observe();
}

void ShapingEnv::Restore(State state) {
  const auto n = static_cast<size_t>(num_envs());
  SAND_CHECK(state.episodes.size() == n && state.sources.size() == n, state.episodes.size(), n);
  state_ = std::move(state);
  results_.assign(n, std::nullopt);
}

StepBatch ShapingEnv::Step(std::span<const float> action_na) {
  const auto n = static_cast<size_t>(num_envs());
  SAND_CHECK(action_na.size() == n * kActionSize, action_na.size(), n);
  std::vector<EpisodeState>& episodes = state_.episodes;
  std::vector<Action> actions(n);
  for (size_t i = 0; i < n; ++i) {
    if (autoreset_ == Autoreset::kDisabled && episodes[i].ended())
      throw Error(fmt::format("environment {} has ended its episode: reset it before a step", i));
    std::copy_n(action_na.begin() + static_cast<std::ptrdiff_t>(i * kActionSize), kActionSize,
                actions[i].begin());
  }
  // Rows that ended in the step before give no result.
  results_ = StepEpisodes(world_, config_.episode, episodes, actions);

  StepBatch batch;
  for (size_t i = 0; i < n; ++i) {
    const EpisodeState& episode = episodes[i];
    const bool stepped = results_[i].has_value();
    batch.reward.push_back(stepped ? static_cast<float>(results_[i]->reward.total()) : 0);
    batch.terminated.push_back(stepped && episode.terminated);
    batch.truncated.push_back(stepped && episode.truncated);
    if (stepped && episode.ended())
      batch.finished.push_back(
          {episode.episode_return, episode.strokes(), EpisodeMetrics(episode, config_.episode)});
  }
  batch.observation = EmptyBatch();
  batch.final_observation = EmptyBatch();
  ParallelFor(num_envs(), world_.threads, [&](int index) {
    const auto i = static_cast<size_t>(index);
    if (autoreset_ == Autoreset::kSameStep && episodes[i].ended()) {
      EncodeInto(index, batch.final_observation);
      episodes[i] = NewEpisode(state_.sources[i]);
    } else if (!results_[i]) {
      episodes[i] = NewEpisode(state_.sources[i]);
    }
    EncodeInto(index, batch.observation);
  });
  return batch;
}

}  // namespace sandwright
