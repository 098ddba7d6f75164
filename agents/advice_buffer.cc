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

AdviceBuffer::AdviceBuffer(const ObservationSpec& spec, int64_t strokes, int64_t capacity)
    : spec_(spec), strokes_(strokes), capacity_(capacity) {
  SAND_CHECK(strokes > 0 && capacity > 0, strokes, capacity);
}

int64_t AdviceBuffer::row_size() const {
  return spec_.map_size() + spec_.vec_size() + strokes_ * (kActionSize + 2);
}

void AdviceBuffer::Add(std::span<const float> map, std::span<const float> vec,
                       std::span<const TriedStroke> tried) {
  double total = 0, sum = 0;
  for (const TriedStroke& stroke : tried) total += stroke.weight;
  SAND_CHECK(total > 0 && std::ssize(tried) <= strokes_, total, tried.size());
  if (size() < capacity_) values_.resize(values_.size() + static_cast<size_t>(row_size()));
  const auto row = values_.begin() + next_ * row_size();
  auto action = std::ranges::copy(vec, std::ranges::copy(map, row).out).out;
  const auto rewards = row + row_size() - 2 * strokes_, shares = rewards + strokes_;
  for (int64_t k = 0; k < strokes_; ++k) {
    const bool repeated = k >= std::ssize(tried);
    const TriedStroke& stroke = repeated ? tried.back() : tried[static_cast<size_t>(k)];
    if (!repeated) sum += stroke.weight;
    action = std::ranges::copy(stroke.action, action).out;
    rewards[k] = static_cast<float>(stroke.reward);
    shares[k] = static_cast<float>(sum / total);
  }
  next_ = (next_ + 1) % capacity_;
}

AdviceBuffer::Examples AdviceBuffer::Sample(int64_t count, int64_t tried,
                                            RandomStream& stream) const {
  SAND_CHECK(!values_.empty());
  Examples out{{torch::empty({count, std::ssize(spec_.channels), spec_.rows, spec_.columns}),
                torch::empty({count, spec_.vec_size()})},
               torch::empty({count, kActionSize}),
               torch::empty({count * tried, kActionSize}),
               torch::empty({count * tried})};
  const auto copy = [](const float* from, int64_t size, torch::Tensor& to, int64_t row) {
    std::copy_n(from, size, to.data_ptr<float>() + row * size);
  };
  for (int64_t i = 0; i < count; ++i) {
    const float* row = values_.data() +
                       static_cast<int64_t>(stream.Index(static_cast<uint64_t>(size()))) * row_size();
    const float* const actions = row + spec_.map_size() + spec_.vec_size();
    const float* const rewards = row + row_size() - 2 * strokes_;
    const float* const shares = rewards + strokes_;
    const auto chosen = std::min<int64_t>(
        std::upper_bound(shares, shares + strokes_, static_cast<float>(stream.Uniform())) - shares,
        strokes_ - 1);
    copy(row, spec_.map_size(), out.observation.map, i);
    copy(row + spec_.map_size(), spec_.vec_size(), out.observation.vec, i);
    copy(actions + chosen * kActionSize, kActionSize, out.action, i);
    for (int64_t k = 0; k < tried; ++k) {
      const auto drawn = static_cast<int64_t>(stream.Index(static_cast<uint64_t>(strokes_)));
      copy(actions + drawn * kActionSize, kActionSize, out.tried, i * tried + k);
      copy(rewards + drawn, 1, out.reward, i * tried + k);
    }
  }
  return out;
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
