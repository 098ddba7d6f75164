// The newest states that an expert was asked about, with its best strokes.
#pragma once

#include <span>
#include <vector>

#include "agents/tensors.h"
#include "data/base/random.h"
#include "env/safetensors.h"

namespace sandwright {

class AdviceBuffer {
 public:
  struct Examples {
    ObservationTensors observation;  // [B, ...]
    torch::Tensor action;            // [B, 7]
  };

  // `keep` strokes a state. Memory grows until `capacity` states are there; then the oldest is
  // overwritten.
  AdviceBuffer(const ObservationSpec& spec, int64_t keep, int64_t capacity);

  // `map` and `vec` of one observation; 1 to `keep` strokes with their positive weights.
  void Add(std::span<const float> map, std::span<const float> vec, std::span<const Action> actions,
           std::span<const double> weights);
  int64_t size() const { return static_cast<int64_t>(values_.size()) / row_size(); }

  // Independent draws, each state with one of its strokes, drawn by weight; size() > 0.
  Examples Sample(int64_t count, RandomStream& stream) const;

  void Save(Safetensors& content) const;
  // Throws Error naming `source` where the rows are of another size or more than the capacity.
  void Load(const Safetensors& content, const std::string& source);

 private:
  int64_t row_size() const;

  ObservationSpec spec_;
  int64_t keep_, capacity_;
  int64_t next_ = 0;           // row that is written next
  std::vector<float> values_;  // [size, row_size]: map, vec, strokes, the sums of their shares so far
};

}  // namespace sandwright
