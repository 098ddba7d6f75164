#include "env/stress_rollouts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "env/heightfield.h"
#include "env/load_sand_model.h"
#include "tests/support/needle_sand.h"

namespace sandwright {
namespace {

constexpr auto kQuiet = [](int64_t) {};

class ShippedSurrogate : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, ShippedSurrogate, ::testing::Values("default", "fast"),
                         [](const auto& test) { return std::string(test.param); });

TEST_P(ShippedSurrogate, StaysSoundOnHardBeds) {
  const auto model = LoadSandModel(GetParam(), {});
  const auto run = [&](int threads) {
    return RunStressRollouts(
        *model, {.strokes = 70, .strokes_per_rollout = 10, .seed = 3, .threads = threads}, kQuiet);
  };
  const std::vector<StressTally> one = run(1), two = run(2);
  ASSERT_EQ(one.size(), StressBeds().size());
  int64_t limited = 0;
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_TRUE(one[i].sound()) << one[i].ToJson().dump(1);
    EXPECT_LT(one[i].stroke_drift_rel, 2e-6) << one[i].bed;
    EXPECT_EQ(one[i].strokes, 10);
    EXPECT_EQ(one[i].steepest, two[i].steepest) << one[i].bed;
    limited += one[i].limited;
  }
  EXPECT_GT(limited, 10);
}

TEST(StressRollouts, SeeWhatIsBroken) {
  const auto run = [](float height_m) {
    return RunStressRollouts(NeedleSand(height_m), {.strokes = 700}, kQuiet)[3];  // flat, 20 mm
  };
  EXPECT_TRUE(run(0).sound());
  const StressTally high = run(0.001f);  // nothing is moved, so nothing can rise
  EXPECT_EQ(high.too_high, 100);
  EXPECT_NEAR(high.rollout_drift_rel, 0.1 / (0.02 * 60 * 60), 1e-6);
  EXPECT_GT(high.slope_last, 50 * high.slope_first);
  EXPECT_EQ(run(-0.0015f).below_floor, 100 - 13);  // 20 mm last 13 strokes
  EXPECT_EQ(run(NAN).not_finite, 1);
}

TEST(StressRollouts, NoSandStandsHigherThanAQuarterConeInACorner) {
  // A cone of 30 mm at 45 degrees: a quarter of pi r^3 / 3.
  const double volume_m3 = std::numbers::pi * std::pow(0.03, 3) / 12;
  EXPECT_NEAR(HighestPossible(0.05, volume_m3, 45), 0.08, 1e-9);
  EXPECT_EQ(HighestPossible(0.05, 0, 33), 0.05);
}

TEST(StressRollouts, AModelDoesNotDriftFromItself) {
  const Heightfield model;
  const BoxDrift drift = RunBoxDrift(model, model, 3, 1);
  ASSERT_EQ(drift.difference.Accrued().size(), 3u);
  EXPECT_EQ(drift.difference.Accrued().back().rmse_mm, 0);
  EXPECT_LT(drift.volume_drift_rel, 1e-6);
}

}  // namespace
}  // namespace sandwright
