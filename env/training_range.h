// How far a stroke lies beyond those that a surrogate was trained on.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "env/safetensors.h"
#include "env/surrogate_encoding.h"

namespace sandwright {

// What the training strokes asked of the net, in five amounts a stroke: the root mean square over the
// active cells of the channels height, cut, blade, remaining and change. One-sided on purpose: a
// stroke that moves less than those is no risk. (docs/surrogate.md, "Judging a model", compares
// this with other measures.)
class TrainingRange {
 public:
  // At least one stroke.
  explicit TrainingRange(std::span<const SurrogateInput> strokes);
  // Tensor range.amounts; Error naming `source` where it is missing or is not five positive values.
  TrainingRange(const Safetensors& file, const std::string& source);
  void Save(Safetensors& file) const;
  // Whether `file` keeps a range: older files do not.
  static bool In(const Safetensors& file);

  // Root mean square of the amounts, each over its own over the training strokes, in units of the
  // 99th percentile of that: 1 = as far out as one in a hundred training strokes, more is beyond.
  double Distance(const SurrogateInput& stroke) const;

 private:
  std::vector<float> amounts_;  // what a distance of 1 is in each
};

}  // namespace sandwright
