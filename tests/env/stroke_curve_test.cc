#include "env/stroke_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace sandwright {
namespace {

TEST(StrokeCurve, FindsThePowerAndWhatATenthCosts) {
  std::vector<StrokeCurvePoint> points;
  for (const int strokes : {10, 40, 160}) points.push_back({strokes, 3 / std::sqrt(strokes)});
  const auto curve = FitStrokeCurve(points);
  ASSERT_TRUE(curve.has_value());
  EXPECT_NEAR(curve->exponent, 0.5, 1e-9);
  // A tenth less takes 1 / 0.9^2 times the strokes.
  EXPECT_NEAR(curve->MoreStrokes(160, 0.1).value(), 160 * (1 / 0.81 - 1), 1e-6);
}

TEST(StrokeCurve, CannotTellFromOneCountOrARise) {
  EXPECT_FALSE(FitStrokeCurve({}).has_value());
  EXPECT_FALSE(FitStrokeCurve(std::vector<StrokeCurvePoint>{{10, 3.0}, {10, 2.0}}).has_value());
  // At or below the floor there is nothing to take a logarithm of.
  EXPECT_FALSE(FitStrokeCurve(std::vector<StrokeCurvePoint>{{10, 3.0}, {20, 0.0}}).has_value());
  const auto rising = FitStrokeCurve(std::vector<StrokeCurvePoint>{{10, 2.0}, {20, 3.0}});
  ASSERT_TRUE(rising.has_value());
  EXPECT_FALSE(rising->MoreStrokes(20, 0.1).has_value());
}

}  // namespace
}  // namespace sandwright
