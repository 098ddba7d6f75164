#include "env/reward.h"

#include <gtest/gtest.h>

#include "data/task.h"

namespace sandwright {
namespace {

// 2 x 2 cells of 10 mm: the goal, 50 mm everywhere, counts in the first row.
HeightMap Goal() {
  HeightMap goal(2, 2, 0.01, 0.05f);
  goal.mask = {1, 1, 0, 0};
  return goal;
}

HeightMap Sand(std::vector<float> height_m) {
  HeightMap map(2, 2, 0.01);
  map.height_m = std::move(height_m);
  return map;
}

RewardConfig Config() {
  return {.per_mm = 2, .stroke_cost = 0.1, .outside_cost_per_cm3 = 0.5, .rejected_cost = 0.4};
}

TEST(Reward, CountsTheDropOfTheErrorAndWhatItCost) {
  // Error 8 mm -> 5 mm; 2 mm + 4 mm of change outside on 1 cm^2 each: 0.6 cm^3.
  const Reward reward = StrokeReward(Config(), Sand({0.06f, 0.044f, 0.05f, 0.05f}),
                                     Sand({0.056f, 0.046f, 0.052f, 0.046f}), Goal());
  EXPECT_NEAR(reward.progress, 2 * 3, 1e-5);
  EXPECT_DOUBLE_EQ(reward.stroke, -0.1);
  EXPECT_NEAR(reward.outside, -0.3, 1e-5);
  EXPECT_EQ(reward.rejected, 0);
  EXPECT_NEAR(reward.total(), 6 - 0.1 - 0.3, 1e-5);
}

TEST(Reward, HarmIsNegative) {
  const Reward reward =
      StrokeReward(Config(), Sand({0.05f, 0.05f, 0, 0}), Sand({0.052f, 0.05f, 0, 0}), Goal());
  EXPECT_NEAR(reward.progress, -2, 1e-5);
}

TEST(Reward, RejectedStrokeCostsBoth) {
  const Reward reward = RejectedReward(Config());
  EXPECT_EQ(reward.progress, 0);
  EXPECT_DOUBLE_EQ(reward.total(), -0.5);
}

TEST(Reward, ProgressAddsUpToTheWholeDropWhateverTheWay) {
  const HeightMap start = Sand({0.06f, 0.03f, 0.05f, 0.05f}),
                  detour = Sand({0.09f, 0.01f, 0.05f, 0.05f}),
                  end = Sand({0.051f, 0.049f, 0.05f, 0.05f});
  const double direct = StrokeReward(Config(), start, end, Goal()).progress;
  const double two = StrokeReward(Config(), start, detour, Goal()).progress +
                     StrokeReward(Config(), detour, end, Goal()).progress;
  EXPECT_NEAR(direct, two, 1e-9);
  EXPECT_NEAR(direct, 2e3 * (GoalError(start, Goal()) - GoalError(end, Goal())), 1e-9);
}

}  // namespace
}  // namespace sandwright
