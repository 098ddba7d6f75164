#include "agents/advice_buffer.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "agents/trainer.h"
#include "data/base/error.h"

namespace sandwright {
namespace {
constexpr const char* kRows = "advice";
constexpr const char* kNext = "advice.next";
}  // namespace

AdviceBuffer::AdviceBuffer(const ObservationSpec& spec, int64_t keep, int64_t capacity)
    : spec_(spec), keep_(keep), capacity_(capacity) {
  SAND_CHECK(keep > 0 && capacity > 0, keep, capacity);
}

int64_t AdviceBuffer::row_size() const {
  return spec_.map_size() + spec_.vec_size() + keep_ * (kActionSize + 1);
}

void AdviceBuffer::Add(std::span<const float> map, std::span<const float> vec,
                       std::span<const Action> actions, std::span<const double> weights) {
  SAND_CHECK(!actions.empty() && actions.size() == weights.size() &&
                 static_cast<int64_t>(actions.size()) <= keep_,
             actions.size(), weights.size());
  if (size() < capacity_) values_.resize(values_.size() + static_cast<size_t>(row_size()));
  const auto row = values_.begin() + next_ * row_size();
  auto out = std::ranges::copy(map, row).out;
  out = std::ranges::copy(vec, out).out;
  for (const Action& action : actions) out = std::ranges::copy(action, out).out;
  const auto shares = row + row_size() - keep_;
  std::fill(out, shares, 0.0f);
  double total = 0, sum = 0;
  for (const double weight : weights) total += weight;
  for (int64_t k = 0; k < keep_; ++k) {
    if (k < std::ssize(weights)) sum += weights[static_cast<size_t>(k)];
    shares[k] = static_cast<float>(sum / total);
  }
  next_ = (next_ + 1) % capacity_;
}

AdviceBuffer::Examples AdviceBuffer::Sample(int64_t count, RandomStream& stream) const {
  SAND_CHECK(!values_.empty());
  auto map = torch::empty({count, std::ssize(spec_.channels), spec_.rows, spec_.columns}),
       vec = torch::empty({count, spec_.vec_size()}), action = torch::empty({count, kActionSize});
  for (int64_t i = 0; i < count; ++i) {
    const float* row = values_.data() +
                       static_cast<int64_t>(stream.Index(static_cast<uint64_t>(size()))) * row_size();
    const float* const actions = row + spec_.map_size() + spec_.vec_size();
    const float* const shares = row + row_size() - keep_;
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

void AdviceBuffer::Save(Safetensors& content) const {
  content.tensors[kRows] = {{size(), row_size()}, values_};
  content.metadata[kNext] = nlohmann::json(next_).dump();
}

void AdviceBuffer::Load(const Safetensors& content, const std::string& source) {
  const NamedTensor& saved = content.Tensor(kRows, source);
  const auto next = ParsedMetadata(content, kNext, source);
  if (saved.shape.size() != 2 || saved.shape[1] != row_size())
    throw Error(source + ": the kept states belong to another observation or expert.keep");
  if (saved.shape[0] > capacity_)
    throw Error(fmt::format("{}: {} states are kept; allowed by expert.buffer_size: {}", source,
                            saved.shape[0], capacity_));
  if (!next.is_number_integer() || next < 0 || next > saved.shape[0])
    throw Error(source + ": the cursor of the kept states is damaged");
  values_ = saved.values;
  next_ = next;
  if (size() < capacity_) next_ = size();  // of a smaller buffer that was full
}

}  // namespace sandwright
