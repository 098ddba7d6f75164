#include "env/paper_protocol.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace sandwright {
namespace {

constexpr int kPixels = 256;
constexpr double kPixel_m = 0.001;
constexpr double kRange_m = 0.150;  // of the 8 bits

double Quantised_mm(double height_m) {
  const double level = std::clamp(std::round(height_m / kRange_m * 255), 0.0, 255.0);
  return level * kRange_m / 255 * 1e3;
}

}  // namespace

PaperScore ScorePaperCrop(const HeightMap& truth, const HeightMap& prediction,
                          const ToolPath& path) {
  SAND_CHECK(!path.empty());
  const BladePose &first = path.front(), &last = path.back();
  const double dx = last.x_m - first.x_m, dy = last.y_m - first.y_m;
  const double down = std::hypot(dx, dy) > 1e-6 ? std::atan2(dy, dx) : last.yaw_rad;
  const double cx = (first.x_m + last.x_m) / 2, cy = (first.y_m + last.y_m) / 2;

  std::vector<std::pair<double, double>> heights_m;  // truth, prediction
  double lowest_m = std::numeric_limits<double>::infinity();
  for (int row = 0; row < kPixels; ++row) {
    for (int column = 0; column < kPixels; ++column) {
      const double along = (row + 0.5 - kPixels / 2.0) * kPixel_m;
      const double across = (column + 0.5 - kPixels / 2.0) * kPixel_m;
      const double x = cx + along * std::cos(down) - across * std::sin(down);
      const double y = cy + along * std::sin(down) + across * std::cos(down);
      if (x < 0 || y < 0 || x >= truth.width_m() || y >= truth.depth_m()) continue;
      heights_m.emplace_back(HeightAt(truth, x, y), HeightAt(prediction, x, y));
      lowest_m = std::min({lowest_m, heights_m.back().first, heights_m.back().second});
    }
  }
  if (heights_m.empty()) throw Error("the paper's crop around the stroke lies outside the box");
  PaperScore score;
  double squared = 0;
  for (const auto& [t, p] : heights_m) {
    const double error = std::abs(Quantised_mm(p - lowest_m) - Quantised_mm(t - lowest_m));
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
