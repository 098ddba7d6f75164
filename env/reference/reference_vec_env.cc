#include "env/reference/reference_vec_env.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "data/base/error.h"
#include "data/base/parallel.h"

namespace sandwright {

ReferenceVecEnv::ReferenceVecEnv(const std::string& name, int num_envs, int threads,
                                 uint64_t first_row)
    : threads_(threads), first_row_(first_row) {
  if (num_envs < 1)
    throw Error(fmt::format("{}: {} environments; allowed: 1 or more", name, num_envs));
  if (threads < 1) throw Error(fmt::format("{}: {} threads; allowed: 1 or more", name, threads));
  for (int i = 0; i < num_envs; ++i)
    rows_.push_back({MakeReferenceTask(name), NumpyRandom(0), {}, {}});
  observation_spec_.numbers = spec().observation;
  observation_spec_.vec_high = std::numeric_limits<float>::infinity();
  observation_spec_.vec_low = -observation_spec_.vec_high;
  Reset(0);
}

template <class Body>
void ReferenceVecEnv::ForRows(const Body& body) {
  const size_t rows = rows_.size(), parts = std::min(rows, static_cast<size_t>(threads_));
  ParallelFor(static_cast<int>(parts), threads_, [&](int part) {
    const auto p = static_cast<size_t>(part);
    for (size_t i = p * rows / parts; i < (p + 1) * rows / parts; ++i) body(i);
  });
}

ObservationBatch ReferenceVecEnv::Reset(uint64_t seed) {
  const auto size = static_cast<size_t>(observation_spec_.vec_size());
  ObservationBatch batch{{}, std::vector<float>(rows_.size() * size)};
  ForRows([&](size_t i) {
    rows_[i].random = NumpyRandom(seed + first_row_ + i);
    rows_[i].episode = {};
    rows_[i].task->Reset(rows_[i].random, std::span(batch.vec).subspan(i * size, size));
  });
  return batch;
}

void ReferenceVecEnv::StepRow(size_t i, std::span<const float> action_na, StepBatch& batch) {
  Row& row = rows_[i];
  const auto size = static_cast<size_t>(observation_spec_.vec_size());
  const auto seen = std::span(batch.observation.vec).subspan(i * size, size);
  const ReferenceStep step = row.task->Step(action_na, seen);
  row.episode.episode_return += step.reward;
  ++row.episode.length;
  batch.reward[i] = static_cast<float>(step.reward);
  batch.terminated[i] = step.terminated;
  batch.truncated[i] = !step.terminated && row.episode.length >= spec().max_steps;
  if (!batch.terminated[i] && !batch.truncated[i]) return;
  std::ranges::copy(seen, std::span(batch.final_observation.vec).subspan(i * size).begin());
  row.finished = std::exchange(row.episode, {});
  row.task->Reset(row.random, seen);
}

StepBatch ReferenceVecEnv::Step(std::span<const float> action_na) {
  const size_t n = rows_.size(), size = static_cast<size_t>(action_size());
  SAND_CHECK(action_na.size() == n * size, action_na.size(), n, size);
  CheckAction(spec(), action_na);
  std::vector<float> scaled(action_na.begin(), action_na.end());
  for (float& value : scaled) value *= static_cast<float>(spec().action_limit);
  const ObservationBatch empty{{}, std::vector<float>(n * spec().observation.size())};
  const std::vector<uint8_t> none(n);
  StepBatch batch{empty, empty, std::vector<float>(n), none, none, {}};
  ForRows([&](size_t i) { StepRow(i, std::span(scaled).subspan(i * size, size), batch); });
  for (size_t i = 0; i < n; ++i) {
    if (batch.terminated[i] || batch.truncated[i]) batch.finished.push_back(rows_[i].finished);
  }
  return batch;
}

}  // namespace sandwright
