#include "env/paper_protocol.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "env/paper_encoding.h"

namespace sandwright {

PaperScore ScorePaperCrop(const HeightMap& truth, const HeightMap& prediction,
                          const ToolPath& path) {
  const PaperFrame frame(path);
  std::vector<std::pair<double, double>> heights_m;  // truth, prediction
  double lowest_m = std::numeric_limits<double>::infinity();
  for (int row = 0; row < kPaperPixels; ++row) {
    for (int column = 0; column < kPaperPixels; ++column) {
      const Eigen::Vector2d p_m = frame.ToBox(row + 0.5, column + 0.5);
      if (!InsideWalls(truth, p_m)) continue;
      heights_m.emplace_back(HeightAt(truth, p_m.x(), p_m.y()),
                             HeightAt(prediction, p_m.x(), p_m.y()));
      lowest_m = std::min({lowest_m, heights_m.back().first, heights_m.back().second});
    }
  }
  if (heights_m.empty()) throw Error("the paper's crop around the stroke lies outside the box");
  PaperScore score;
  double squared = 0;
  for (const auto& [t, p] : heights_m) {
    const double error =
        1e3 * kPaperLevel_m * std::abs(PaperLevel(p - lowest_m) - PaperLevel(t - lowest_m));
    score.mae_mm += error;
    squared += error * error;
    score.max_abs_mm = std::max(score.max_abs_mm, error);
  }
  const double count = static_cast<double>(heights_m.size());
  score.mae_mm /= count;
  score.rmse_mm = std::sqrt(squared / count);
  return score;
}

}  // namespace sandwright
