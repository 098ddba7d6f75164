#include "env/rollout_score.h"

#include <algorithm>
#include <cmath>

namespace sandwright {

void RolloutScore::Add(int step, const HeightMap& truth, const HeightMap& prediction,
                       const CellRect& window) {
  if (step == 1) sequences_.emplace_back();
  SAND_CHECK(!sequences_.empty() && std::ssize(sequences_.back()) == step - 1, step);
  Sums sums;
  for (int row = window.row0; row < window.row1; ++row) {
    for (int column = window.column0; column < window.column1; ++column) {
      if (!truth.valid.empty() && truth.valid[truth.Index(row, column)] == 0) continue;
      const double error_mm =
          1e3 * (static_cast<double>(prediction.At(row, column)) - truth.At(row, column));
      sums.squared_mm2 += error_mm * error_mm;
      ++sums.cells;
    }
  }
  sequences_.back().push_back(sums);
}

std::vector<AccruedError> RolloutScore::Accrued() const {
  size_t longest = 0;
  for (const auto& sequence : sequences_) longest = std::max(longest, sequence.size());
  std::vector<AccruedError> accrued;
  for (size_t i = 0; i < longest; ++i) {
    AccruedError error{.step = static_cast<int>(i) + 1};
    double squared_mm2 = 0;
    for (const auto& sequence : sequences_) {
      if (sequence.size() <= i) continue;
      ++error.sequences;
      error.cells += sequence[i].cells;
      squared_mm2 += sequence[i].squared_mm2;
    }
    if (error.cells == 0) continue;  // the camera saw none of them
    error.rmse_mm = std::sqrt(squared_mm2 / static_cast<double>(error.cells));
    accrued.push_back(error);
  }
  return accrued;
}

std::optional<double> RolloutScore::GrowthExponent() const {
  double xx = 0, xy = 0;
  for (const auto& sequence : sequences_) {
    std::vector<double> x, y;
    for (size_t i = 0; i < sequence.size(); ++i) {
      if (!(sequence[i].squared_mm2 > 0)) continue;
      x.push_back(std::log(static_cast<double>(i) + 1));
      y.push_back(std::log(sequence[i].squared_mm2 / static_cast<double>(sequence[i].cells)) / 2);
    }
    double mean_x = 0, mean_y = 0;
    for (size_t i = 0; i < x.size(); ++i) {
      mean_x += x[i] / static_cast<double>(x.size());
      mean_y += y[i] / static_cast<double>(x.size());
    }
    for (size_t i = 0; i < x.size(); ++i) {
      xx += (x[i] - mean_x) * (x[i] - mean_x);
      xy += (x[i] - mean_x) * (y[i] - mean_y);
    }
  }
  if (!(xx > 0)) return std::nullopt;
  return xy / xx;
}

}  // namespace sandwright
