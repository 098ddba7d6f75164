// The error of predicted sand against what really happened: the definitions behind every figure.
//
// Errors are heights in millimetres on the cells of the stroke's score window: StrokeWindow of the
// path, grown until it holds every cell that the truth or the prediction changed by more than 1 mm,
// clipped to the box. Cells that the camera did not see (valid = 0) do not count.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "env/stroke_window.h"

namespace sandwright {

inline constexpr double kChangeThreshold_m = 1e-3;  // a cell that moved less has not changed

// One stroke: sums over the cells of its score window.
struct StrokeScore {
  std::string file;       // where it came from, for people
  int file_index = 0;     // of it among the files that were scored
  int stroke = 0;         // index in the file
  char complexity = 'A';  // ComplexityClass
  int64_t cells = 0;
  double absolute_mm = 0;  // sum |prediction - truth|
  double squared_mm2 = 0;  // sum (prediction - truth)^2
  double change_mm2 = 0;   // sum (truth - before)^2
  double max_abs_mm = 0;   // max |prediction - truth|
  // Net volume that the prediction adds / volume that it moves (half the sum of |change|), over the
  // whole map; none where it moves nothing.
  std::optional<double> volume_drift_rel;
  std::optional<double> training_distance;  // Outcome's, of a model that knows it

  double mse_mm2() const { return squared_mm2 / static_cast<double>(cells); }
};

// The score window on the grid of the maps, which is one and the same.
CellRect ScoreWindow(const HeightMap& before, const HeightMap& truth, const HeightMap& prediction,
                     const ToolPath& path);

// Error where no cell of the window was seen. The first fields and training_distance are the
// caller's.
StrokeScore ScoreStroke(const HeightMap& before, const HeightMap& truth,
                        const HeightMap& prediction, const ToolPath& path);

// Sums over cells -> figures. Means over cells pool all windows, so a large window counts more;
// none where the figure is not defined (no stroke, nothing changed, floor above the change).
struct ScoreSummary {
  int strokes = 0;
  std::optional<double> mae_mm;            // mean over cells
  std::optional<double> rmse_mean_mm;      // root of the mean squared error over cells
  std::optional<double> rmse_mode_mm;      // peak of the density of the strokes' RMSE
  std::optional<double> mean_max_abs_mm;   // mean over strokes
  std::optional<double> r2_change;         // 1 - sum squared error / sum squared true change
  std::optional<double> explained;         // ExplainedShare
  std::optional<double> volume_drift_rel;  // mean over the strokes that have one
};
ScoreSummary Summarise(std::span<const StrokeScore> strokes, double floor_mm);

// 1 - (MSE - floor^2) / (change^2 - floor^2), from means over cells: the share of what can be
// predicted that is. None where the change does not pass the floor.
std::optional<double> ExplainedShare(double mse_mm2, double change_mm2, double floor_mm2);

// The noise that no prediction can pass, from pairs of replicates: the same stroke on the same
// terrain with another packing of the grains. Half the squared difference of the two `after` over
// the cells that either stroke changed by more than 1 mm, spread over the pair's score window.
class NoiseFloor {
 public:
  void Add(const HeightMap& before_a, const HeightMap& after_a, const HeightMap& before_b,
           const HeightMap& after_b, const ToolPath& path);
  int pairs() const { return pairs_; }
  // Root of the mean over all windows [mm]; 0 without pairs.
  double rmse_mm() const;
  // Mean over the pairs of the largest |difference| over those cells [mm]: it carries the noise of both
  // replicates, a prediction's error that of one. None without pairs.
  std::optional<double> max_abs_mm() const;

 private:
  int pairs_ = 0;
  int64_t cells_ = 0;
  double squared_mm2_ = 0, max_abs_mm_ = 0;  // the latter summed over the pairs
};

}  // namespace sandwright
