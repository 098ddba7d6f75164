#include "agents/replay_buffer.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "agents/trainer.h"
#include "data/base/error.h"

namespace sandwright {
namespace {
constexpr const char* kRows = "replay";
constexpr const char* kNext = "replay.next";
}  // namespace

ReplayBuffer::ReplayBuffer(int64_t observation_size, int64_t action_size, int64_t capacity)
    : observation_size_(observation_size), action_size_(action_size), capacity_(capacity) {
  SAND_CHECK(observation_size > 0 && action_size > 0 && capacity > 0);
}

void ReplayBuffer::Add(const ObservationBatch& before, std::span<const float> action_na,
                       const StepBatch& step) {
  const auto width = static_cast<size_t>(observation_size_),
             actions = static_cast<size_t>(action_size_), row = static_cast<size_t>(row_size());
  for (size_t i = 0; i < step.reward.size(); ++i) {
    if (size() < capacity_) values_.resize(values_.size() + row);
    const bool ended = step.terminated[i] || step.truncated[i];
    const auto& after = ended ? step.final_observation.vec : step.observation.vec;
    auto out = values_.begin() + next_ * row_size();
    out = std::ranges::copy(std::span(before.vec).subspan(i * width, width), out).out;
    out = std::ranges::copy(action_na.subspan(i * actions, actions), out).out;
    out = std::ranges::copy(std::span(after).subspan(i * width, width), out).out;
    *out++ = step.reward[i];
    *out++ = step.terminated[i] ? 0.0f : 1.0f;
    next_ = (next_ + 1) % capacity_;
  }
}

Transitions ReplayBuffer::Sample(int64_t count, RandomStream& stream, torch::Device device) const {
  SAND_CHECK(!values_.empty());
  auto rows = torch::empty({count, row_size()});
  for (int64_t i = 0; i < count; ++i) {
    const auto drawn = static_cast<int64_t>(stream.Index(static_cast<uint64_t>(size())));
    std::copy_n(values_.begin() + drawn * row_size(), row_size(),
                rows.data_ptr<float>() + i * row_size());
  }
  const auto parts = rows.to(device).split_with_sizes(
      {observation_size_, action_size_, observation_size_, 1, 1}, 1);
  return {parts[0], parts[1], parts[2], parts[3], parts[4]};
}

void ReplayBuffer::Save(Safetensors& content) const {
  content.tensors[kRows] = {{size(), row_size()}, values_};
  content.metadata[kNext] = nlohmann::json(next_).dump();
}

void ReplayBuffer::Load(const Safetensors& content, const std::string& source) {
  const NamedTensor& saved = content.Tensor(kRows, source);
  const auto next = ParsedMetadata(content, kNext, source);
  if (saved.shape.size() != 2 || saved.shape[1] != row_size())
    throw Error(source + ": the replay buffer belongs to another task");
  if (saved.shape[0] > capacity_)
    throw Error(fmt::format("{}: the replay buffer holds {} transitions; allowed by buffer_size: {}",
                            source, saved.shape[0], capacity_));
  if (!next.is_number_integer() || next < 0 || next > saved.shape[0])
    throw Error(source + ": the replay buffer's cursor is damaged");
  values_ = saved.values;
  next_ = next;
  // Of a buffer that was full and is larger now: go on behind its rows.
  if (size() < capacity_) next_ = size();
}

}  // namespace sandwright
