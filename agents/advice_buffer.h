// The newest states that an expert was asked about, with its best strokes.
#pragma once

#include <span>
#include <vector>

#include "agents/row_ring.h"
#include "agents/tensors.h"
#include "env/action.h"

namespace sandwright {

class AdviceBuffer {
 public:
  struct Examples {
    ObservationTensors observation;  // [B, ...]
    torch::Tensor action;            // [B, 7]
  };

  // `keep` strokes a state, of the last `capacity` states.
  AdviceBuffer(const ObservationSpec& spec, int64_t keep, int64_t capacity);

  // `map` and `vec` of one observation; 1 to `keep` strokes with their positive weights.
  void Add(std::span<const float> map, std::span<const float> vec, std::span<const Action> actions,
           std::span<const double> weights);
  int64_t size() const { return rows_.size(); }

  // Independent draws, each state with one of its strokes, drawn by weight; size() > 0.
  Examples Sample(int64_t count, RandomStream& stream) const;

  void Save(Safetensors& content) const { rows_.Save(content); }
  void Load(const Safetensors& content, const std::string& source) { rows_.Load(content, source); }

 private:
  ObservationSpec spec_;
  int64_t keep_;
  RowRing rows_;  // map, vec, strokes, the sums of their shares so far
};

}  // namespace sandwright
