#include "env/score.h"

#include <algorithm>
#include <cmath>

#include "env/kernel_density.h"

namespace sandwright {
namespace {

constexpr double kMillimetres = 1e3;

bool Seen(const HeightMap& map, size_t cell) { return map.valid.empty() || map.valid[cell] != 0; }

template <class Body>
void ForEachCell(const HeightMap& map, const CellRect& rect, const Body& body) {
  for (int row = rect.row0; row < rect.row1; ++row) {
    for (int column = rect.column0; column < rect.column1; ++column) body(map.Index(row, column));
  }
}

double Difference_mm(const HeightMap& a, const HeightMap& b, size_t cell) {
  return (static_cast<double>(a.height_m[cell]) - b.height_m[cell]) * kMillimetres;
}

}  // namespace

CellRect ScoreWindow(const HeightMap& before, const HeightMap& truth, const HeightMap& prediction,
                     const ToolPath& path) {
  return Union(StrokeWindow(before, path),
               Union(ChangedBounds(before, truth, kChangeThreshold_m),
                     ChangedBounds(before, prediction, kChangeThreshold_m)));
}

StrokeScore ScoreStroke(const HeightMap& before, const HeightMap& truth,
                        const HeightMap& prediction, const ToolPath& path) {
  StrokeScore score;
  ForEachCell(before, ScoreWindow(before, truth, prediction, path), [&](size_t cell) {
    if (!Seen(before, cell) || !Seen(truth, cell)) return;
    const double error_mm = Difference_mm(prediction, truth, cell);
    const double change_mm = Difference_mm(truth, before, cell);
    ++score.cells;
    score.absolute_mm += std::abs(error_mm);
    score.squared_mm2 += error_mm * error_mm;
    score.change_mm2 += change_mm * change_mm;
    score.max_abs_mm = std::max(score.max_abs_mm, std::abs(error_mm));
  });
  if (score.cells == 0) throw Error("the stroke's score window holds no cell that was seen");
  double net = 0, moved = 0;
  for (size_t cell = 0; cell < before.size(); ++cell) {
    const double change_mm = Difference_mm(prediction, before, cell);
    net += change_mm;
    moved += std::abs(change_mm) / 2;
  }
  if (moved > 0) score.volume_drift_rel = net / moved;
  return score;
}

std::optional<double> ExplainedShare(double mse_mm2, double change_mm2, double floor_mm2) {
  if (!(change_mm2 > floor_mm2)) return std::nullopt;
  return 1 - (mse_mm2 - floor_mm2) / (change_mm2 - floor_mm2);
}

ScoreSummary Summarise(std::span<const StrokeScore> strokes, double floor_mm) {
  ScoreSummary summary;
  summary.strokes = static_cast<int>(strokes.size());
  if (strokes.empty()) return summary;
  double cells = 0, absolute = 0, squared = 0, change = 0, max_abs = 0, drift = 0;
  int with_drift = 0;
  std::vector<double> rmse_mm;
  for (const StrokeScore& s : strokes) {
    cells += static_cast<double>(s.cells);
    absolute += s.absolute_mm;
    squared += s.squared_mm2;
    change += s.change_mm2;
    max_abs += s.max_abs_mm;
    rmse_mm.push_back(std::sqrt(s.mse_mm2()));
    if (s.volume_drift_rel) drift += *s.volume_drift_rel, ++with_drift;
  }
  const double count = static_cast<double>(strokes.size());
  summary.mae_mm = absolute / cells;
  summary.rmse_mean_mm = std::sqrt(squared / cells);
  summary.rmse_mode_mm = KernelDensity(rmse_mm).Mode();
  summary.mean_max_abs_mm = max_abs / count;
  if (change > 0) summary.r2_change = 1 - squared / change;
  summary.explained = ExplainedShare(squared / cells, change / cells, floor_mm * floor_mm);
  if (with_drift > 0) summary.volume_drift_rel = drift / with_drift;
  return summary;
}

void NoiseFloor::Add(const HeightMap& before_a, const HeightMap& after_a, const HeightMap& before_b,
                     const HeightMap& after_b, const ToolPath& path) {
  double worst_mm = 0;
  const CellRect changed_b = ChangedBounds(before_b, after_b, kChangeThreshold_m);
  ForEachCell(before_a, Union(ScoreWindow(before_a, after_a, after_a, path), changed_b),
              [&](size_t cell) {
                ++cells_;
                if (std::max(std::abs(Difference_mm(after_a, before_a, cell)),
                             std::abs(Difference_mm(after_b, before_b, cell))) <=
                    kChangeThreshold_m * kMillimetres)
                  return;
                const double difference_mm = Difference_mm(after_a, after_b, cell);
                squared_mm2_ += difference_mm * difference_mm / 2;
                worst_mm = std::max(worst_mm, std::abs(difference_mm));
              });
  max_abs_mm_ += worst_mm;
  ++pairs_;
}

double NoiseFloor::rmse_mm() const {
  return cells_ > 0 ? std::sqrt(squared_mm2_ / static_cast<double>(cells_)) : 0;
}

std::optional<double> NoiseFloor::max_abs_mm() const {
  return pairs_ > 0 ? std::optional(max_abs_mm_ / pairs_) : std::nullopt;
}

}  // namespace sandwright
