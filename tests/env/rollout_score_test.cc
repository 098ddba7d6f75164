#include "env/rollout_score.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace sandwright {
namespace {

// One sequence whose error is first_mm * step^p on every cell of the window.
void AddSequence(RolloutScore& score, int steps, double first_mm, double p) {
  const HeightMap truth(10, 10, 0.01, 0.05f);
  for (int step = 1; step <= steps; ++step) {
    HeightMap prediction = truth;
    for (float& h : prediction.height_m)
      h += static_cast<float>(1e-3 * first_mm * std::pow(step, p));
    score.Add(step, truth, prediction, {0, 0, std::min(step, 10), 10});
  }
}

TEST(RolloutScore, PoolsTheSequencesThatReachAStep) {
  RolloutScore score;
  AddSequence(score, 3, 1, 1);
  AddSequence(score, 5, 2, 1);
  const std::vector<AccruedError> accrued = score.Accrued();
  ASSERT_EQ(accrued.size(), 5u);
  EXPECT_EQ(accrued[2].step, 3);
  EXPECT_EQ(accrued[2].sequences, 2);
  EXPECT_EQ(accrued[2].cells, 2 * 30);
  EXPECT_NEAR(accrued[2].rmse_mm, 3 * std::sqrt((1 + 4) / 2.0), 1e-3);
  EXPECT_EQ(accrued[4].sequences, 1);
  EXPECT_NEAR(accrued[4].rmse_mm, 10, 1e-3);
}

TEST(RolloutScore, TheExponentDoesNotDependOnWhichSequencesAreLong) {
  for (const double p : {0.5, 1.0, 1.7}) {
    RolloutScore score;
    AddSequence(score, 4, 3, p);
    AddSequence(score, 12, 0.2, p);
    EXPECT_NEAR(score.GrowthExponent().value(), p, 1e-2);
  }
}

TEST(RolloutScore, NoExponentFromSingleStepsOrWithoutError) {
  RolloutScore score;
  EXPECT_TRUE(score.Accrued().empty());
  AddSequence(score, 1, 1, 1);
  AddSequence(score, 1, 2, 1);
  AddSequence(score, 5, 0, 1);
  EXPECT_FALSE(score.GrowthExponent().has_value());
}

}  // namespace
}  // namespace sandwright
