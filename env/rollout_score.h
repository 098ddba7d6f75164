// How fast errors pile up where a model predicts stroke after stroke from its own predictions.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "env/score.h"

namespace sandwright {

// After the first `step` strokes of a sequence: over the sequences that reach it.
struct AccruedError {
  int step = 0;
  int sequences = 0;
  int64_t cells = 0;  // of the windows of all of them
  double rmse_mm = 0;
};

class RolloutScore {
 public:
  // The error after one more stroke of the sequence, over the cells of `window` that were seen. A new
  // sequence begins where step is 1; steps come in order.
  void Add(int step, const HeightMap& truth, const HeightMap& prediction, const CellRect& window);

  // By step from 1 on.
  std::vector<AccruedError> Accrued() const;
  // p of RMSE ~ step^p: 1/2 where errors are independent, 1 where they add up, more where they feed on
  // each other. The least-squares slope of log RMSE against log step with an intercept for each
  // sequence, so that it does not matter which sequences are long. None without two steps of one
  // sequence whose errors are not zero.
  std::optional<double> GrowthExponent() const;

 private:
  struct Sums {
    double squared_mm2 = 0;
    int64_t cells = 0;
  };
  std::vector<std::vector<Sums>> sequences_;  // [sequence][step - 1]
};

}  // namespace sandwright
