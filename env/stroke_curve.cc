#include "env/stroke_curve.h"

#include <cmath>
#include <vector>

namespace sandwright {

std::optional<double> StrokeCurve::MoreStrokes(int strokes, double share) const {
  if (exponent <= 0) return std::nullopt;
  return strokes * (std::pow(1 - share, -1 / exponent) - 1);
}

std::optional<StrokeCurve> FitStrokeCurve(std::span<const StrokeCurvePoint> points) {
  std::vector<double> x, y;
  double mean_x = 0, mean_y = 0;
  for (const StrokeCurvePoint& point : points) {
    if (point.strokes <= 0 || point.excess_mm2 <= 0) continue;
    x.push_back(std::log(point.strokes));
    y.push_back(std::log(point.excess_mm2));
    mean_x += x.back();
    mean_y += y.back();
  }
  if (x.empty()) return std::nullopt;
  mean_x /= static_cast<double>(x.size());
  mean_y /= static_cast<double>(x.size());
  double covariance = 0, variance = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    covariance += (x[i] - mean_x) * (y[i] - mean_y);
    variance += (x[i] - mean_x) * (x[i] - mean_x);
  }
  constexpr double kSameCount = 1e-12;  // rounding alone
  if (variance < kSameCount) return std::nullopt;
  return StrokeCurve{-covariance / variance};
}

}  // namespace sandwright
