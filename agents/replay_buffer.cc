#include "agents/replay_buffer.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "agents/trainer.h"
#include "data/base/error.h"

namespace sandwright {
namespace {
constexpr const char* kRows = "transitions";
constexpr const char* kNext = "transitions.next";
}  // namespace

ReplayBuffer::ReplayBuffer(const ObservationSpec& spec, int64_t action_size, int64_t capacity)
    : spec_(spec), action_size_(action_size), capacity_(capacity) {
  SAND_CHECK(observation_size() > 0 && action_size > 0 && capacity > 0);
}

void ReplayBuffer::Add(std::span<const float> observation, std::span<const float> action,
                       std::span<const float> next_observation, float reward, float discount) {
  SAND_CHECK(std::ssize(observation) == observation_size() && std::ssize(action) == action_size_ &&
                 std::ssize(next_observation) == observation_size(),
             observation.size(), action.size(), next_observation.size());
  if (size() < capacity_) values_.resize(values_.size() + static_cast<size_t>(row_size()));
  auto out = values_.begin() + next_ * row_size();
  for (const auto& part : {observation, action, next_observation})
    out = std::ranges::copy(part, out).out;
  *out++ = reward;
  *out++ = discount;
  next_ = (next_ + 1) % capacity_;
}

Transitions ReplayBuffer::Sample(int64_t count, RandomStream& stream, torch::Device device) const {
  SAND_CHECK(!values_.empty());
  auto rows = torch::empty({count, row_size()});
  for (int64_t i = 0; i < count; ++i) {
    const auto drawn = static_cast<int64_t>(stream.Index(static_cast<uint64_t>(size())));
    std::copy_n(values_.begin() + drawn * row_size(), row_size(),
                rows.data_ptr<float>() + i * row_size());
  }
  const int64_t map = spec_.map_size(), vec = spec_.vec_size();
  const auto parts = rows.to(device).split_with_sizes({map, vec, action_size_, map, vec, 1, 1}, 1);
  const auto observed = [&](size_t part) {
    return ObservationTensors{
        parts[part].reshape({count, std::ssize(spec_.channels), spec_.rows, spec_.columns}),
        parts[part + 1]};
  };
  return {observed(0), parts[2], observed(3), parts[5], parts[6]};
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
