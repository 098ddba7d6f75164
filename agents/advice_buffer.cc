#include "agents/advice_buffer.h"

#include <algorithm>

#include "data/base/error.h"

namespace sandwright {
namespace {

int64_t RowSize(const ObservationSpec& spec, int64_t keep) {
  return spec.map_size() + spec.vec_size() + keep * (kActionSize + 1);
}

}  // namespace

AdviceBuffer::AdviceBuffer(const ObservationSpec& spec, int64_t keep, int64_t capacity)
    : spec_(spec), keep_(keep), rows_("advice", RowSize(spec, keep), capacity) {
  SAND_CHECK(keep > 0, keep);
}

void AdviceBuffer::Add(std::span<const float> map, std::span<const float> vec,
                       std::span<const Action> actions, std::span<const double> weights) {
  SAND_CHECK(!actions.empty() && actions.size() == weights.size() &&
                 static_cast<int64_t>(actions.size()) <= keep_,
             actions.size(), weights.size());
  const std::span<float> row = rows_.Next();
  auto out = std::ranges::copy(map, row.begin()).out;
  out = std::ranges::copy(vec, out).out;
  for (const Action& action : actions) out = std::ranges::copy(action, out).out;
  const auto shares = row.end() - keep_;
  std::fill(out, shares, 0.0f);
  double total = 0, sum = 0;
  for (const double weight : weights) total += weight;
  for (int64_t k = 0; k < keep_; ++k) {
    if (k < std::ssize(weights)) sum += weights[static_cast<size_t>(k)];
    shares[k] = static_cast<float>(sum / total);
  }
}

AdviceBuffer::Examples AdviceBuffer::Sample(int64_t count, RandomStream& stream) const {
  auto map = torch::empty({count, std::ssize(spec_.channels), spec_.rows, spec_.columns}),
       vec = torch::empty({count, spec_.vec_size()}), action = torch::empty({count, kActionSize});
  for (int64_t i = 0; i < count; ++i) {
    const float* const row = rows_.Draw(stream).data();
    const float* const actions = row + spec_.map_size() + spec_.vec_size();
    const float* const shares = actions + keep_ * kActionSize;
    const auto chosen = std::min<int64_t>(
        std::upper_bound(shares, shares + keep_, static_cast<float>(stream.Uniform())) - shares,
        keep_ - 1);
    std::copy_n(row, spec_.map_size(), map.data_ptr<float>() + i * spec_.map_size());
    std::copy_n(row + spec_.map_size(), spec_.vec_size(),
                vec.data_ptr<float>() + i * spec_.vec_size());
    std::copy_n(actions + chosen * kActionSize, kActionSize,
                action.data_ptr<float>() + i * kActionSize);
  }
  return {{map, vec}, action};
}

}  // namespace sandwright
