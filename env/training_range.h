// How far a stroke lies from those that a surrogate was trained on.
#pragma once

#include <string>
#include <vector>

#include "env/safetensors.h"
#include "env/surrogate_encoding.h"

namespace sandwright {

// The spread of the training strokes over 24 numbers a stroke: mean and standard deviation of each
// channel over the active cells.
class TrainingRange {
 public:
  // At least one stroke.
  explicit TrainingRange(const std::vector<SurrogateInput>& strokes);
  // Tensors range.mean and range.deviation; Error naming `source` where one is missing or has
  // another shape.
  TrainingRange(const Safetensors& file, const std::string& source);
  void Save(Safetensors& file) const;

  // Root mean square, over the numbers, of their distance from the training mean in its standard
  // deviations: about 1 for a stroke like those, larger beyond.
  double Distance(const SurrogateInput& stroke) const;

 private:
  std::vector<float> mean_, deviation_;
};

}  // namespace sandwright
