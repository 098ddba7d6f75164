#include "env/feasible_goal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "data/base/random.h"
#include "data/task.h"
#include "env/goal_wish.h"
#include "env/goals.h"
#include "env/varied_goal.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

auto Fails(const std::string& text) { return ThrowsMessage<Error>(HasSubstr(text)); }

HeightMap Bed(float depth_m = 0.08f) { return HeightMap(60, 80, 0.01, depth_m); }

// A goal of heights by place; NaN does not count.
HeightMap Goal(const std::function<double(double, double)>& height_m) {
  HeightMap goal = Bed();
  goal.mask.assign(goal.size(), 1);
  for (int row = 0; row < goal.rows; ++row) {
    for (int column = 0; column < goal.columns; ++column) {
      const double h = height_m((column + 0.5) * 0.01, (row + 0.5) * 0.01);
      goal.mask[goal.Index(row, column)] = !std::isnan(h);
      if (!std::isnan(h)) goal.At(row, column) = static_cast<float>(h);
    }
  }
  return goal;
}

double Volume(const HeightMap& map, const std::vector<uint8_t>& mask) {
  double sum_m = 0;
  for (size_t i = 0; i < map.size(); ++i) sum_m += mask[i] ? map.height_m[i] : 0;
  return sum_m * map.cell_size_m * map.cell_size_m;
}

TEST(FeasibleGoal, AGoalThatSandHoldsStaysAsItIs) {
  const HeightMap goal = MakeGoal({.kind = GoalKind::kMound, .x_m = 0.4, .y_m = 0.3, .half_width_m = 0.05, .rise_m = 0.03},
                                  Bed(), {0, 0, 0.8, 0.6}, 0.05);
  const Feasibility found = JudgeGoal(goal, Bed(), {}, nullptr);
  EXPECT_NEAR(found.volume_missing_m3, 0, 1e-9);
  EXPECT_EQ(found.steep_share, 0);
  EXPECT_NEAR(found.steepest_deg, std::atan(0.45) * 180 / std::numbers::pi, 1);
  EXPECT_EQ(found.below_floor_share, 0);
  EXPECT_FALSE(found.out_of_reach_share);
  const HeightMap feasible = NearestFeasible(goal, Bed(), {});
  EXPECT_LT(GoalError(feasible, goal), 2e-4);
  EXPECT_EQ(feasible.mask, goal.mask);
}

TEST(FeasibleGoal, SteepWallsSlideToRestAndTheVolumeBalances) {
  const auto wall = [](double x, double) { return x < 0.4 ? 0.12 : 0.05; };
  const HeightMap goal = Goal(wall);
  const FeasibilityConfig config;
  const Feasibility found = JudgeGoal(goal, Bed(), config, nullptr);
  EXPECT_NEAR(found.volume_missing_m3, (0.085 - 0.08) * 0.8 * 0.6, 1e-6);
  EXPECT_NEAR(found.steepest_deg, std::atan(7.0) * 180 / std::numbers::pi, 0.1);
  EXPECT_NEAR(found.steep_share, 2.0 / 80, 1e-9);  // the cells on both sides of the step
  const HeightMap feasible = NearestFeasible(goal, Bed(), config);
  const Feasibility after = JudgeGoal(feasible, Bed(), config, nullptr);
  EXPECT_EQ(after.steep_share, 0);
  EXPECT_LT(after.steepest_deg, 33.1);
  EXPECT_NEAR(Volume(feasible, goal.mask), Volume(Bed(), goal.mask), 1e-7);
  EXPECT_NEAR(feasible.At(30, 2) - feasible.At(30, 77), 0.07, 1e-4);  // far from the wall only the level changed
}

TEST(FeasibleGoal, GroovesNarrowerThanTheBladeCloseAndWideOnesStay) {
  const auto grooves = [](double x, double) { return std::abs(x - 0.2) < 0.02 || std::abs(x - 0.6) < 0.045 ? 0.07 : 0.08; };
  const HeightMap goal = Goal(grooves);
  const Feasibility found = JudgeGoal(goal, Bed(), {}, nullptr);
  EXPECT_NEAR(found.narrow_share, 4.0 / 80, 1e-9);  // the narrow one of 40 mm
  EXPECT_NEAR(found.narrow_worst_m, 0.01, 1e-6);
  const HeightMap feasible = NearestFeasible(goal, Bed(), {});
  EXPECT_NEAR(feasible.At(30, 20), feasible.At(30, 40), 1e-5);
  EXPECT_NEAR(feasible.At(30, 60), feasible.At(30, 40) - 0.01, 1e-5);
  FeasibilityConfig any;
  any.narrowest_pit_m = any.narrowest_crest_m = 0;
  EXPECT_EQ(JudgeGoal(goal, Bed(), any, nullptr).narrow_share, 0);
}

TEST(FeasibleGoal, TheFloorIsNeverPassedAndUncountedCellsAreKept) {
  const auto pit = [](double x, double y) {
    if (x < 0.1) return kNothing;
    return std::hypot(x - 0.45, y - 0.3) < 0.15 ? -0.02 : 0.09;
  };
  const HeightMap goal = Goal(pit);
  const Feasibility found = JudgeGoal(goal, Bed(), {}, nullptr);
  EXPECT_GT(found.below_floor_share, 0.1);
  FeasibilityConfig closed;
  closed.free_spread_m = 0;
  const HeightMap feasible = NearestFeasible(goal, Bed(), closed);
  EXPECT_GE(std::ranges::min(feasible.height_m), 0);
  EXPECT_NEAR(Volume(feasible, goal.mask), Volume(Bed(), goal.mask), 1e-7);
  EXPECT_EQ(feasible.At(30, 3), 0.08f);
  CheckTask({Bed(), feasible, 10}, "the goal");
}

// A pit in the middle of free sand is dug where it is: what comes out of it lies around it.
TEST(FeasibleGoal, FreeGroundTakesAndGivesSand) {
  const auto pit = [](double x, double y) {
    const double r = std::hypot(x - 0.4, y - 0.3);
    return r > 0.15 ? kNothing : 0.08 - 0.02 * std::max(0.0, 1 - r / 0.12);
  };
  const HeightMap goal = Goal(pit);
  EXPECT_LT(GoalError(NearestFeasible(goal, Bed(), {}), goal), 2e-4);
  FeasibilityConfig little;
  little.free_spread_m = 0.0001;
  const HeightMap raised = NearestFeasible(goal, Bed(), little);
  const double free_m2 = 0.8 * 0.6 - 1e-4 * static_cast<double>(std::ranges::count(goal.mask, 1));
  EXPECT_NEAR(Volume(raised, goal.mask), Volume(Bed(), goal.mask) - 0.0001 * free_m2, 1e-6);
}

TEST(FeasibleGoal, EachCellHasItsFaults) {
  // A cliff at x = 0.4, a groove of 20 mm at y = 0.1, and nothing that counts at y > 0.5.
  const HeightMap goal = Goal([](double x, double y) {
    if (y > 0.5) return kNothing;
    return x > 0.4 ? 0.1 : std::abs(y - 0.1) < 0.01 ? 0.075 : 0.08;
  });
  const std::vector<uint8_t> faults = GoalFaults(goal, {.narrowest_crest_m = 0}, nullptr);
  EXPECT_EQ(faults[goal.Index(30, 39)] & kTooSteep, kTooSteep);
  EXPECT_EQ(faults[goal.Index(30, 40)] & kTooSteep, kTooSteep);
  EXPECT_EQ(faults[goal.Index(30, 20)], 0);
  EXPECT_EQ(faults[goal.Index(10, 20)] & kTooNarrow, kTooNarrow);
  EXPECT_EQ(faults[goal.Index(55, 39)], 0);
  const Feasibility judged = JudgeGoal(goal, Bed(), {.narrowest_crest_m = 0}, nullptr);
  const auto steep = std::ranges::count_if(faults, [](uint8_t bits) { return (bits & kTooSteep) != 0; });
  EXPECT_DOUBLE_EQ(judged.steep_share, static_cast<double>(steep) / (50 * 80));
}

TEST(FeasibleGoal, ReachIsTheShareWhereNoStrokeStarts) {
  const HeightMap goal = Goal([](double, double) { return 0.08; });
  const ReachMap reach{.rows = 1, .columns = 4, .width_m = 0.8, .depth_m = 0.6, .share = {0, 1, 0.5f, 1}};
  EXPECT_NEAR(JudgeGoal(goal, Bed(), {}, &reach).out_of_reach_share.value(), 0.25, 1e-9);
  EXPECT_TRUE(ToJson(JudgeGoal(goal, Bed(), {}, &reach)).contains("out_of_reach_share"));
}

TEST(GoalWish, AShapeIsMovedTurnedAndScaled) {
  HeightMap bar(10, 40, 0.005, 0.01f, Datum::kRelative);  // 200 x 50 mm
  WishPlace place{.at_m = Eigen::Vector2d(0.3, 0.2), .scale = 2, .turn_rad = std::numbers::pi / 2, .height_scale = 3, .zero_m = 0.08};
  const Wish wish = PlaceWish(bar, place, Bed(), "bar");
  EXPECT_EQ(std::ranges::count(wish.goal.mask, 1), 40 * 10);  // now 100 mm along x, 400 mm along y
  EXPECT_TRUE(wish.goal.mask[wish.goal.Index(38, 30)]);
  EXPECT_FALSE(wish.goal.mask[wish.goal.Index(20, 40)]);
  EXPECT_FLOAT_EQ(wish.goal.At(20, 30), 0.11f);
  EXPECT_NEAR(wish.cut_share, 0, 1e-9);
  place.at_m = Eigen::Vector2d(0.3, 0);
  EXPECT_NEAR(PlaceWish(bar, place, Bed(), "bar").cut_share, 0.5, 1e-9);
  place.at_m = Eigen::Vector2d(5, 5);
  EXPECT_THAT([&] { PlaceWish(bar, place, Bed(), "bar"); }, Fails("bar: 0.4 x 0.1 m at its place cover 0 cells"));
  place.scale = 1000;
  EXPECT_THAT([&] { PlaceWish(bar, place, Bed(), "bar"); }, Fails("bar: 200 x 50 m, and the box is 0.8 x 0.6 m; is the unit right"));
}

TEST(GoalWish, AMapOfTheSameGridIsTakenOverCellByCell) {
  HeightMap scan = Bed();
  RandomStream stream(1);
  for (float& h : scan.height_m) h = static_cast<float>(stream.Uniform(0.05, 0.1));
  scan.At(3, 4) = std::nanf("");
  const Wish wish = PlaceWish(scan, {}, Bed(), "scan");
  EXPECT_EQ(wish.goal.At(7, 9), scan.At(7, 9));
  EXPECT_EQ(std::ranges::count(wish.goal.mask, 0), 1);
}

TEST(VaryGoal, SetsAroundOneGoal) {
  const HeightMap goal = MakeGoal({.kind = GoalKind::kRidge, .x_m = 0.4, .y_m = 0.3, .half_length_m = 0.1, .half_width_m = 0.02, .rise_m = 0.02},
                                  Bed(), {0, 0, 0.8, 0.6}, 0.03);
  RandomStream stream(7);
  double lowest_m = 1, highest_m = 0;
  for (int i = 0; i < 20; ++i) {
    const Task task = VaryGoal(Bed(), goal, {}, 9, stream);
    CheckTask(task, "a variation");
    const double free_m2 = 0.8 * 0.6 - 1e-4 * static_cast<double>(std::ranges::count(task.goal.mask, 1));
    EXPECT_NEAR(Volume(task.goal, task.goal.mask), Volume(task.terrain, task.goal.mask),
                FeasibilityConfig{}.free_spread_m * free_m2 + 1e-7);
    double highest = 0;
    for (size_t k = 0; k < task.goal.size(); ++k)
      if (task.goal.mask[k]) highest = std::max(highest, static_cast<double>(task.goal.height_m[k]));
    lowest_m = std::min(lowest_m, highest);
    highest_m = std::max(highest_m, highest);
  }
  EXPECT_GT(highest_m - lowest_m, 0.004);  // the depth varies
  RandomStream a(3), b(3);
  EXPECT_EQ(TasksSha256({VaryGoal(Bed(), goal, {}, 9, a)}), TasksSha256({VaryGoal(Bed(), goal, {}, 9, b)}));
  VaryConfig upside_down;
  upside_down.depth_low = 2;
  EXPECT_THAT([&] { VaryGoal(Bed(), goal, upside_down, 9, a); }, Fails("vary.depth_high = 1.3"));
}

}  // namespace
}  // namespace sandwright
