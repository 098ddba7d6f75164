#include "agents/row_ring.h"

#include <spdlog/fmt/fmt.h>

#include "agents/trainer.h"
#include "data/base/error.h"

namespace sandwright {

RowRing::RowRing(std::string name, int64_t row_size, int64_t capacity)
    : name_(std::move(name)), row_size_(row_size), capacity_(capacity) {
  SAND_CHECK(row_size > 0 && capacity > 0, row_size, capacity);
}

std::span<float> RowRing::Next() {
  const auto width = static_cast<size_t>(row_size_);
  if (size() < capacity_) values_.resize(values_.size() + width);
  const std::span row = std::span(values_).subspan(static_cast<size_t>(next_) * width, width);
  next_ = (next_ + 1) % capacity_;
  return row;
}

std::span<const float> RowRing::Draw(RandomStream& stream) const {
  SAND_CHECK(!values_.empty());
  const auto width = static_cast<size_t>(row_size_);
  return std::span(values_).subspan(stream.Index(static_cast<uint64_t>(size())) * width, width);
}

void RowRing::Save(Safetensors& content) const {
  content.tensors[name_] = {{size(), row_size_}, values_};
  content.metadata[name_ + ".next"] = nlohmann::json(next_).dump();
}

void RowRing::Load(const Safetensors& content, const std::string& source) {
  const NamedTensor& saved = content.Tensor(name_, source);
  const auto next = ParsedMetadata(content, name_ + ".next", source);
  if (saved.shape.size() != 2 || saved.shape[1] != row_size_)
    throw Error(fmt::format("{}: the rows of {} are of another task or configuration", source, name_));
  if (saved.shape[0] > capacity_)
    throw Error(fmt::format("{}: {} has {} rows; allowed by buffer_size: {}", source, name_,
                            saved.shape[0], capacity_));
  if (!next.is_number_integer() || next < 0 || next > saved.shape[0])
    throw Error(fmt::format("{}: the cursor of {} is damaged", source, name_));
  values_ = saved.values;
  next_ = next;
  // Of a ring that was full and is larger now: go on behind its rows.
  if (size() < capacity_) next_ = size();
}

}  // namespace sandwright
