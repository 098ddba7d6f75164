#include "agents/replay_buffer.h"

#include <algorithm>

#include "data/base/error.h"

namespace sandwright {
namespace {

int64_t RowSize(const ObservationSpec& spec, int64_t action_size) {
  return 2 * (spec.map_size() + spec.vec_size()) + action_size + 2;
}

}  // namespace

ReplayBuffer::ReplayBuffer(const ObservationSpec& spec, int64_t action_size, int64_t capacity)
    : spec_(spec),
      action_size_(action_size),
      rows_("transitions", RowSize(spec, action_size), capacity) {
  SAND_CHECK(spec.map_size() + spec.vec_size() > 0 && action_size > 0, action_size);
}

void ReplayBuffer::Add(std::span<const float> observation, std::span<const float> action,
                       std::span<const float> next_observation, float reward, float discount) {
  const int64_t seen = spec_.map_size() + spec_.vec_size();
  SAND_CHECK(std::ssize(observation) == seen && std::ssize(action) == action_size_ &&
                 std::ssize(next_observation) == seen,
             observation.size(), action.size(), next_observation.size());
  auto out = rows_.Next().begin();
  for (const auto& part : {observation, action, next_observation})
    out = std::ranges::copy(part, out).out;
  *out++ = reward;
  *out = discount;
}

Transitions ReplayBuffer::Sample(int64_t count, RandomStream& stream, torch::Device device) const {
  auto rows = torch::empty({count, RowSize(spec_, action_size_)});
  for (int64_t i = 0; i < count; ++i)
    std::ranges::copy(rows_.Draw(stream), rows.data_ptr<float>() + i * rows.size(1));
  const int64_t map = spec_.map_size(), vec = spec_.vec_size();
  const auto parts = rows.to(device).split_with_sizes({map, vec, action_size_, map, vec, 1, 1}, 1);
  const auto observed = [&](size_t part) {
    return ObservationTensors{
        parts[part].reshape({count, std::ssize(spec_.channels), spec_.rows, spec_.columns}),
        parts[part + 1]};
  };
  return {observed(0), parts[2], observed(3), parts[5], parts[6]};
}

}  // namespace sandwright
