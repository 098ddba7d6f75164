// How a model's error falls with the strokes that it was trained on, and what a further gain costs.
#pragma once

#include <optional>
#include <span>

namespace sandwright {

struct StrokeCurvePoint {
  int strokes = 0;        // trained on
  double excess_mm2 = 0;  // mean squared error less the floor's square
};

struct StrokeCurve {
  double exponent = 0;  // b of excess ~ strokes^-b

  // Strokes beyond `strokes` until the excess is smaller by `share` (0..1); none where more strokes do
  // not make it smaller.
  std::optional<double> MoreStrokes(int strokes, double share) const;
};

// The power law through points of positive strokes and excess (others are left out), least squares
// of the logarithms. None where fewer than two stroke counts are left.
std::optional<StrokeCurve> FitStrokeCurve(std::span<const StrokeCurvePoint> points);

}  // namespace sandwright
