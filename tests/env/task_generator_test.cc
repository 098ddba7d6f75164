#include "env/task_generator.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "env/random_strokes.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const Region kWhole{0, 0, 0.3, 0.3};

double MaskedVolumeDifference(const HeightMap& terrain, const HeightMap& goal) {
  double sum = 0;
  for (size_t i = 0; i < goal.size(); ++i)
    if (goal.mask[i]) sum += static_cast<double>(goal.height_m[i]) - terrain.height_m[i];
  return sum;
}

// Largest rise over run between a cell and its eight neighbours.
double SteepestSlope(const HeightMap& map) {
  double steepest = 0;
  const auto slope = [&](int row0, int column0, int row1, int column1) {
    const double run_m = map.cell_size_m * std::hypot(row1 - row0, column1 - column0);
    steepest =
        std::max<double>(steepest, std::abs(map.At(row1, column1) - map.At(row0, column0)) / run_m);
  };
  for (int row = 0; row + 1 < map.rows; ++row) {
    for (int column = 0; column + 1 < map.columns; ++column) {
      slope(row, column, row, column + 1);
      slope(row, column, row + 1, column);
      slope(row, column, row + 1, column + 1);
      slope(row, column + 1, row + 1, column);
    }
  }
  return steepest;
}

GoalShape Shape(GoalKind kind) {
  return {.kind = kind,
          .x_m = 0.15,
          .y_m = 0.15,
          .heading_rad = 0,
          .half_length_m = 0.05,
          .half_width_m = 0.02,
          .rise_m = 0.02,
          .slope = 0.4};
}

TEST(Goals, ShapesHaveTheHeightsOfTheirDefinition) {
  // Mound: 20 mm high up to 20 mm from the middle, then down over 50 mm.
  const GoalShape mound = Shape(GoalKind::kMound);
  EXPECT_NEAR(ShapeHeight(mound, 0.15, 0.165), 0.02, 1e-12);
  EXPECT_NEAR(ShapeHeight(mound, 0.195, 0.15), 0.01, 1e-12);
  EXPECT_EQ(ShapeHeight(mound, 0.15, 0.23), 0);
  EXPECT_NEAR(DistanceToFoot(mound, 0.15, 0.23), 0.01, 1e-12);
  EXPECT_NEAR(ShapeHeight(Shape(GoalKind::kCrater), 0.195, 0.15), -0.01, 1e-12);
  // Ridge: its middle line runs 50 mm to both sides along x.
  const GoalShape ridge = Shape(GoalKind::kRidge);
  EXPECT_NEAR(ShapeHeight(ridge, 0.20, 0.165), 0.02, 1e-12);
  EXPECT_NEAR(ShapeHeight(ridge, 0.245, 0.15), 0.01, 1e-12);
  EXPECT_NEAR(ShapeHeight(Shape(GoalKind::kTrench), 0.10, 0.105), -0.01, 1e-12);
  // Terrace: 10 mm above uphill, 10 mm below downhill, 0.4 between.
  const GoalShape terrace = Shape(GoalKind::kTerrace);
  EXPECT_NEAR(ShapeHeight(terrace, 0.16, 0.02), 0.004, 1e-12);
  EXPECT_NEAR(ShapeHeight(terrace, 0.29, 0.15), 0.01, 1e-12);
  EXPECT_NEAR(ShapeHeight(terrace, 0.01, 0.15), -0.01, 1e-12);
  EXPECT_EQ(ShapeHeight(Shape(GoalKind::kLevel), 0.16, 0.02), 0);
}

TEST(Goals, EveryKindKeepsTheVolumeAndTheSlope) {
  HeightMap terrain(30, 30, 0.01);
  for (int row = 0; row < 30; ++row)
    for (int column = 0; column < 30; ++column)
      terrain.At(row, column) =
          static_cast<float>(0.05 + 0.004 * std::sin(0.5 * row) * std::cos(0.4 * column));
  for (std::string_view name : kGoalNames) {
    const GoalShape shape = Shape(ParseGoalKind(std::string(name)));
    const HeightMap goal = MakeGoal(shape, terrain, kWhole, 1);
    EXPECT_NEAR(MaskedVolumeDifference(terrain, goal), 0, 900 * 1e-8) << name;
    EXPECT_LE(SteepestSlope(goal), 0.4 + 1e-5) << name;
    EXPECT_EQ(std::accumulate(goal.mask.begin(), goal.mask.end(), 0), 900) << name;
  }
}

TEST(Goals, MaskIsThePlaceOrTheShapesSurroundings) {
  const HeightMap terrain(30, 30, 0.01, 0.05f);
  const HeightMap near = MakeGoal(Shape(GoalKind::kMound), terrain, kWhole, 0.01);
  double cells = 0;
  for (uint8_t m : near.mask) cells += m;
  EXPECT_NEAR(cells * 1e-4, 3.14159 * 0.08 * 0.08,
              1e-3);  // foot at 70 mm and 10 mm around it; 10 cells of the edge
  EXPECT_NEAR(MaskedVolumeDifference(terrain, near), 0, 1e-6);
  EXPECT_EQ(near.At(0, 0), 0.05f);  // untouched where it does not count
  const HeightMap place = MakeGoal(Shape(GoalKind::kMound), terrain, {0.1, 0.1, 0.12, 0.1}, 1);
  EXPECT_EQ(std::accumulate(place.mask.begin(), place.mask.end(), 0), 12 * 10);
}

TEST(Goals, SaysWhatIsWrong) {
  const HeightMap terrain(30, 30, 0.01, 0.01f);
  EXPECT_THAT(
      [] { ParseGoalKind("hill"); },
      ThrowsMessage<Error>(HasSubstr("\"hill\" is unknown; allowed: level, mound, crater")));
  EXPECT_THAT([&] { MakeGoal(Shape(GoalKind::kCrater), terrain, kWhole, 1); },
              ThrowsMessage<Error>(HasSubstr("the crater goal reaches")));
  GoalShape outside = Shape(GoalKind::kMound);
  outside.x_m = 2;
  EXPECT_THAT([&] { MakeGoal(outside, terrain, kWhole, 0.01); },
              ThrowsMessage<Error>(HasSubstr("covers no cell")));
}

TEST(TaskGenerator, TasksAreFeasibleAndWithinTheDifficulty) {
  TaskConfig config;
  config.difficulty_low_m = 0.004;
  config.difficulty_high_m = 0.007;
  double sum_m = 0;
  for (uint64_t n = 0; n < 60; ++n) {
    RandomStream stream(7, kTrainingTasks, n);
    const Task task = GenerateTask(config, stream);
    CheckTask(task, "task");
    const double error_m = GoalError(task.terrain, task.goal);
    EXPECT_GE(error_m, 0.004 - 1e-6);
    EXPECT_LE(error_m, 0.007 + 1e-6);
    EXPECT_NEAR(MaskedVolumeDifference(task.terrain, task.goal), 0, 1e-5);
    EXPECT_LE(SteepestSlope(task.goal), 0.5 + 1e-4);
    EXPECT_EQ(task.max_strokes, 10);
    sum_m += error_m;
  }
  EXPECT_NEAR(sum_m / 60, 0.0055, 0.0005);  // spread over the range, not at one end
}

TEST(TaskGenerator, LettersAreReachableAndBothRaisedAndSunk) {
  TaskConfig config;
  config.goals = {"letters"};
  int raised = 0;
  for (uint64_t n = 0; n < 20; ++n) {
    RandomStream stream(7, kTrainingTasks, n);
    const Task task = GenerateTask(config, stream);
    CheckTask(task, "task");
    EXPECT_NEAR(MaskedVolumeDifference(task.terrain, task.goal), 0, 1e-5);
    EXPECT_LE(SteepestFace(task.goal), 0.505);
    // The corner is the plane beside the letters.
    const auto [low, high] = std::ranges::minmax(task.goal.height_m);
    raised += high - task.goal.At(0, 0) > task.goal.At(0, 0) - low;
  }
  EXPECT_GT(raised, 4);
  EXPECT_LT(raised, 16);
}

TEST(TaskGenerator, AreaIsTheShareOfThePlaceThatCounts) {
  TaskConfig config;
  config.area_low = 0.3;
  config.area_high = 0.7;
  double sum = 0;
  for (uint64_t n = 0; n < 40; ++n) {
    RandomStream stream(7, kTrainingTasks, n);
    const Task task = GenerateTask(config, stream);
    const double share = std::accumulate(task.goal.mask.begin(), task.goal.mask.end(), 0) / 900.0;
    EXPECT_GE(share, 0.3 * 0.94);  // sides are whole cells
    EXPECT_LE(share, 0.7 * 1.06);
    EXPECT_NEAR(MaskedVolumeDifference(task.terrain, task.goal), 0, 1e-5);
    sum += share;
  }
  EXPECT_NEAR(sum / 40, 0.5, 0.06);
}

TEST(TaskGenerator, TerrainsOfUnknownFloorGetGoalsToo) {
  HeightMap terrain(30, 30, 0.01, 0, Datum::kRelative);
  terrain.At(3, 3) = -0.02f;
  TaskConfig config;
  config.goals = {"crater"};
  RandomStream stream(1);
  const Task task = GenerateGoal(config, terrain, stream);
  const auto [low, high] = std::ranges::minmax(task.goal.height_m);
  EXPECT_GT(high - low, 0.005);
}

TEST(TaskGenerator, DrawnGoalsTakeTheConfiguredPlace) {
  TaskConfig config;
  config.goal_width_m = 0.2;
  config.goal_depth_m = 0.15;
  cv::Mat grey = cv::Mat::zeros(30, 30, CV_32F);
  grey(cv::Rect(8, 8, 14, 14)) = 1;
  RandomStream stream(1);
  const HeightMap terrain = DrawTerrain(config, stream);
  const Task task = GenerateDrawnGoal(config, grey, 0.015, terrain, stream);
  CheckTask(task, "task");
  EXPECT_NEAR(std::accumulate(task.goal.mask.begin(), task.goal.mask.end(), 0), 15 * 15, 15);
}

TEST(TaskGenerator, StreamsDecideEverything) {
  const auto draw = [](uint64_t seed, uint64_t purpose, uint64_t index) {
    RandomStream stream(seed, purpose, index);
    const Task task = GenerateTask({}, stream);
    return std::pair(task.terrain.height_m, task.goal.height_m);
  };
  EXPECT_EQ(draw(1, kTrainingTasks, 5), draw(1, kTrainingTasks, 5));
  EXPECT_NE(draw(1, kTrainingTasks, 5).first, draw(1, kEvaluationTasks, 5).first);
  EXPECT_NE(draw(1, kTrainingTasks, 5).first, draw(1, kTrainingTasks, 6).first);
  EXPECT_NE(draw(1, kTrainingTasks, 5).first, draw(2, kTrainingTasks, 5).first);
}

TEST(TaskGenerator, GoalTakesItsPlaceInALargerBox) {
  TaskConfig config;
  config.width_m = 0.6;
  config.depth_m = 0.4;
  config.goal_width_m = 0.2;
  config.goal_depth_m = 0.15;
  std::set<size_t> first_cells;
  for (uint64_t n = 0; n < 10; ++n) {
    RandomStream stream(3, kTrainingTasks, n);
    const Task task = GenerateTask(config, stream);
    EXPECT_EQ(task.goal.rows, 40);
    EXPECT_EQ(task.goal.columns, 60);
    EXPECT_EQ(std::accumulate(task.goal.mask.begin(), task.goal.mask.end(), 0), 20 * 15);
    first_cells.insert(
        static_cast<size_t>(std::ranges::find(task.goal.mask, 1) - task.goal.mask.begin()));
  }
  EXPECT_GT(first_cells.size(), 5u);
}

TEST(TaskGenerator, SaysWhatIsWrong) {
  const auto generate = [](auto change) {
    return [change] {
      TaskConfig config;
      change(config);
      RandomStream stream(1);
      GenerateTask(config, stream);
    };
  };
  EXPECT_THAT(generate([](TaskConfig& c) { c.goals = {"pyramid"}; }),
              ThrowsMessage<Error>(HasSubstr("pyramid")));
  EXPECT_THAT(generate([](TaskConfig& c) { c.goals = {"level", "pyramid"}; }),
              ThrowsMessage<Error>(HasSubstr("\"pyramid\" is unknown; allowed: level, mound, crater, "
                                             "trench, ridge, terrace, letters")));
  EXPECT_THAT(generate([](TaskConfig& c) { c.area_high = 0.5; }),
              ThrowsMessage<Error>(HasSubstr("area_high = 0.5; must be at least area_low = 1")));
  EXPECT_THAT(generate([](TaskConfig& c) {
                c.goals = {"letters"};
                c.narrowest_m = 0.15;
              }),
              ThrowsMessage<Error>(HasSubstr("do not fit into the least places, of 0.300 m (area_low = 1)")));
  // At once, not only when a small place happens to meet a wide letter.
  EXPECT_THAT(generate([](TaskConfig& c) {
                c.goals = {"level", "level", "level", "letters"};
                c.area_low = 0.1;
              }),
              ThrowsMessage<Error>(HasSubstr("of 0.090 m (area_low = 0.1); allowed there: up to 0.027 m")));
  EXPECT_THAT(generate([](TaskConfig& c) { c.goals.clear(); }),
              ThrowsMessage<Error>(HasSubstr("goals is empty")));
  EXPECT_THAT(generate([](TaskConfig& c) { c.difficulty_high_m = 0.001; }),
              ThrowsMessage<Error>(HasSubstr("difficulty_high_m = 0.001")));
  EXPECT_THAT(generate([](TaskConfig& c) { c.difficulty_low_m = c.difficulty_high_m = 0.05; }),
              ThrowsMessage<Error>(HasSubstr("no task of difficulty_low_m = 0.05")));
  EXPECT_THAT(generate([](TaskConfig& c) { c.goal_width_m = 0.5; }),
              ThrowsMessage<Error>(HasSubstr("goal_width_m = 0.5 m; allowed: 0 or 0.02 to 0.3 m")));
  EXPECT_THAT(generate([](TaskConfig& c) { c.width_m = 0.305; }),
              ThrowsMessage<Error>(HasSubstr("width_m")));
}

}  // namespace
}  // namespace sandwright
