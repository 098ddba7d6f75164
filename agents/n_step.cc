#include "agents/n_step.h"

#include <algorithm>

#include "data/base/error.h"

namespace sandwright {

NStep::NStep(const ObservationSpec& spec, int64_t steps, double gamma)
    : map_size_(static_cast<size_t>(spec.map_size())),
      vec_size_(static_cast<size_t>(spec.vec_size())),
      steps_(static_cast<size_t>(steps)),
      gamma_(gamma) {
  SAND_CHECK(steps > 0, steps);
}

void NStep::Add(const ObservationBatch& before, std::span<const float> action_na,
                const StepBatch& step, ReplayBuffer& into) {
  const size_t envs = step.reward.size(), actions = action_na.size() / envs;
  open_.resize(envs);
  const auto row = [&](const ObservationBatch& batch, size_t i) {
    std::vector<float> values(map_size_ + vec_size_);
    std::copy_n(batch.map.begin() + static_cast<std::ptrdiff_t>(i * map_size_), map_size_, values.begin());
    std::copy_n(batch.vec.begin() + static_cast<std::ptrdiff_t>(i * vec_size_), vec_size_,
                values.begin() + static_cast<std::ptrdiff_t>(map_size_));
    return values;
  };
  for (size_t i = 0; i < envs; ++i) {
    const auto action = action_na.subspan(i * actions, actions);
    open_[i].push_back({row(before, i), {action.begin(), action.end()}, step.reward[i]});
    const bool ended = step.terminated[i] || step.truncated[i];
    const auto after = row(ended ? step.final_observation : step.observation, i);
    while (!open_[i].empty() && (ended || open_[i].size() == steps_))
      Emit(open_[i], after, step.terminated[i], into);
  }
}

void NStep::Emit(std::deque<Step>& episode, std::span<const float> after, bool terminated,
                 ReplayBuffer& into) const {
  double reward = 0, discount = 1;
  for (const Step& step : episode) {
    reward += discount * step.reward;
    discount *= gamma_;
  }
  into.Add(episode.front().observation, episode.front().action, after, static_cast<float>(reward),
           terminated ? 0.0f : static_cast<float>(discount));
  episode.pop_front();
}

}  // namespace sandwright
