// The newest states that an expert was asked about, with strokes that it tried.
#pragma once

#include <span>
#include <vector>

#include "agents/networks.h"
#include "env/action.h"
#include "env/safetensors.h"

namespace sandwright {

// A stroke that was tried: its reward, and how much it is to be learnt (0: not at all).
struct TriedStroke {
  Action action{};
  double reward = 0, weight = 0;
};

class AdviceBuffer {
 public:
  struct Examples {
    ObservationTensors observation;  // [B, ...]
    torch::Tensor action;            // [B, 7]: one stroke a state, drawn by weight
    torch::Tensor tried, reward;     // [B * M, 7], [B * M]: M strokes a state, each as likely
  };

  // `strokes` a state. Memory grows until `capacity` states are there; then the oldest is
  // overwritten.
  AdviceBuffer(const ObservationSpec& spec, int64_t strokes, int64_t capacity);

  // `map` and `vec` of one observation; 1 to `strokes` strokes, one of positive weight among them.
  void Add(std::span<const float> map, std::span<const float> vec,
           std::span<const TriedStroke> tried);
  int64_t size() const { return static_cast<int64_t>(values_.size()) / row_size(); }

  // Independent draws of states, with `tried` strokes of each; size() > 0.
  Examples Sample(int64_t count, int64_t tried, RandomStream& stream) const;

  void Save(Safetensors& content) const;
  // Throws Error naming `source` where the rows are of another size or more than the capacity.
  void Load(const Safetensors& content, const std::string& source);

 private:
  int64_t row_size() const;

  ObservationSpec spec_;
  int64_t strokes_, capacity_;
  int64_t next_ = 0;           // row that is written next
  // [size, row_size]: map, vec, actions, rewards, sums of the weights' shares up to each stroke; a
  // state of fewer strokes has its last one several times.
  std::vector<float> values_;
};

}  // namespace sandwright
