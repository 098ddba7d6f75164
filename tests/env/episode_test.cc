#include "env/episode.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "robot_model/safety_gate.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Sets every cell of the map to a height: a world whose outcome is known.
class FloodSand final : public SandModel {
 public:
  explicit FloodSand(float height_m) : height_m_(height_m) {}
  std::string name() const override { return "flood"; }
  const Blade& blade() const override { return blade_; }

 protected:
  std::vector<Outcome> ApplyChecked(std::span<SandState> states,
                                    std::span<const ToolPath>) const override {
    std::vector<Outcome> outcomes(states.size());
    for (size_t i = 0; i < states.size(); ++i) {
      HeightMap map = states[i].map();
      map.height_m.assign(map.size(), height_m_);
      outcomes[i] = {.changed = {0, 0, map.rows, map.columns}, .moved_volume_m3 = 2e-6};
      states[i].Replace(std::move(map));
    }
    return outcomes;
  }

 private:
  Blade blade_;
  float height_m_;
};

// 10 x 20 cells of 10 mm, 50 mm deep; the goal, 60 mm, counts in rows 2-4, columns 12-15.
std::shared_ptr<Task> MakeTask(int max_strokes = 10) {
  auto task = std::make_shared<Task>();
  task->terrain = HeightMap(10, 20, 0.01, 0.05f);
  task->goal = HeightMap(10, 20, 0.01, 0.06f);
  task->goal.mask.assign(200, 0);
  for (int row = 2; row < 5; ++row)
    for (int column = 12; column < 16; ++column) task->goal.mask[task->goal.Index(row, column)] = 1;
  task->max_strokes = max_strokes;
  return task;
}

std::vector<EpisodeState> Start(std::shared_ptr<const Task> task,
                                const EpisodeConfig& config = {}) {
  return {StartEpisode(StillSand(), std::move(task), config, RandomStream(1))};
}

const std::vector<Action> kAction(1);

// The shipped cell with a box of the tasks' size.
Workcell SmallCell() {
  Workcell cell;
  cell.box.width_m = 0.2;
  cell.box.depth_m = 0.1;
  return cell;
}

TEST(RegionOf, IsTheMapOrItsPartAroundTheGoal) {
  const auto task = MakeTask();
  const Region whole = RegionOf(*task, {});
  EXPECT_EQ(whole.x_m, 0);
  EXPECT_DOUBLE_EQ(whole.width_m, 0.2);
  EXPECT_DOUBLE_EQ(whole.depth_m, 0.1);

  EpisodeConfig config{.region_width_m = 0.08, .region_depth_m = 0.08};
  const Region part = RegionOf(*task, config);  // middle of the mask: (0.14, 0.035)
  EXPECT_NEAR(part.x_m, 0.10, 1e-12);
  EXPECT_NEAR(part.y_m, 0, 1e-12);  // moved inside the wall
  EXPECT_EQ(part.depth_m, 0.08);

  config.region_depth_m = 0.3;  // larger than the box: around its middle
  EXPECT_NEAR(RegionOf(*task, config).y_m, -0.1, 1e-12);
  config.region_width_m = 0.03;
  EXPECT_THAT(
      [&] { RegionOf(*task, config); },
      ThrowsMessage<Error>(HasSubstr("the goal counts over 0.040 x 0.030 m; the region "
                                     "(region_width_m, region_depth_m) is 0.030 x 0.300 m")));
}

TEST(StepEpisodes, SuccessTerminates) {
  const FloodSand flood(0.059f);
  auto episodes = Start(MakeTask());
  const auto result = StepEpisodes({.sand = flood}, {}, episodes, kAction);
  EXPECT_TRUE(episodes[0].terminated);
  EXPECT_FALSE(episodes[0].truncated);
  EXPECT_NEAR(result[0]->reward.progress, 9, 1e-4);
  EXPECT_NEAR(episodes[0].episode_return, result[0]->reward.total(), 1e-12);

  const auto metrics = EpisodeMetrics(episodes[0], {});
  EXPECT_NEAR(metrics.at("in_goal_mean_diff_start_mm"), 10, 1e-4);
  EXPECT_NEAR(metrics.at("in_goal_mean_diff_mm"), 1, 1e-4);
  EXPECT_NEAR(metrics.at("error_after_5_mm"), 1, 1e-4);
  EXPECT_EQ(metrics.at("in_goal_cells_changed"), 1);
  EXPECT_EQ(metrics.at("strokes"), 1);
  EXPECT_EQ(metrics.at("success"), 1);
  EXPECT_NEAR(metrics.at("moved_volume_cm3"), 2, 1e-9);
  // 12 cells are 1 mm off the goal; the other 188 are 9 mm off where they were.
  EXPECT_NEAR(metrics.at("rmse_mm"), std::sqrt((12 * 1.0 + 188 * 81.0) / 200), 1e-3);
}

TEST(StepEpisodes, EndedEpisodesAreLeftAlone) {
  const FloodSand flood(0.055f);
  auto episodes = Start(MakeTask(1));
  ASSERT_TRUE(StepEpisodes({.sand = flood}, {}, episodes, kAction)[0].has_value());
  EXPECT_TRUE(episodes[0].terminated);  // budget
  const FloodSand other(0.07f);
  EXPECT_FALSE(StepEpisodes({.sand = other}, {}, episodes, kAction)[0].has_value());
  EXPECT_EQ(episodes[0].sand.map().At(0, 0), 0.055f);
  EXPECT_EQ(episodes[0].strokes(), 1);
}

TEST(StepEpisodes, RejectedStrokeMovesNoSandAndUsesUpBudget) {
  const FloodSand flood(0.055f);
  const SafetyGate gate(SmallCell());
  auto episodes = Start(MakeTask());
  const std::vector<Action> away = {{1, 1, 0, 1, 0, 0, 0}};  // out through the wall
  for (int k = 1; k <= 3; ++k) {
    const auto result = StepEpisodes({.sand = flood, .gate = &gate}, {}, episodes, away);
    EXPECT_FALSE(result[0]->accepted());
    EXPECT_NEAR(result[0]->reward.total(), RejectedReward({}).total(), 1e-12);
    EXPECT_EQ(episodes[0].sand.map().At(0, 0), 0.05f);
    EXPECT_EQ(View(episodes[0]).strokes_used, k);
    EXPECT_EQ(View(episodes[0]).rejected_in_a_row, k);
    EXPECT_EQ(episodes[0].terminated, k == 3);
  }
  EXPECT_EQ(EpisodeMetrics(episodes[0], {}).at("rejected_strokes"), 3);
}

TEST(StepEpisodes, GateMustBeOfTheSameBladeAndBox) {
  const FloodSand flood(0.055f);
  auto episodes = Start(MakeTask());
  Workcell cell = SmallCell();
  cell.tool.blade.width_m = 0.06;
  const SafetyGate other_blade(cell), other_box{Workcell{}};
  EXPECT_THAT(
      [&] { StepEpisodes({.sand = flood, .gate = &other_blade}, {}, episodes, kAction); },
      ThrowsMessage<Error>(HasSubstr("blade is 0.06 x 0.005 m, the sand model's 0.05 x 0.005 m")));
  EXPECT_THAT([&] { StepEpisodes({.sand = flood, .gate = &other_box}, {}, episodes, kAction); },
              ThrowsMessage<Error>(HasSubstr("box is 1.2 x 0.8 m, the terrain 0.2 x 0.1 m")));
  EXPECT_EQ(episodes[0].budget_used, 0);
}

TEST(StepEpisodes, SensorNoiseIsSeenButIsNotTheTruth) {
  const StillSand still;
  const EpisodeConfig config{.sensor = {.noise_m = 0.001}};
  auto episodes = Start(MakeTask(), config);
  const auto spread_mm = [&] {
    const HeightMap& sensed = View(episodes[0]).sensed;
    double sum = 0;
    for (float h : sensed.height_m) sum += std::pow(1e3 * (h - 0.05), 2);
    return std::sqrt(sum / static_cast<double>(sensed.size()));
  };
  EXPECT_NEAR(spread_mm(), 1, 0.15);  // sd of 200 draws: 5 %
  const std::vector<float> first = View(episodes[0]).sensed.height_m;
  StepEpisodes({.sand = still}, config, episodes, kAction);
  EXPECT_NEAR(spread_mm(), 1, 0.15);
  EXPECT_NE(View(episodes[0]).sensed.height_m, first);
  EXPECT_EQ(episodes[0].sand.map().At(3, 3), 0.05f);
  EXPECT_NEAR(episodes[0].goal_error_m.back(), 0.01, 1e-7);
  auto again = Start(MakeTask(), config);
  EXPECT_EQ(View(again[0]).sensed.height_m, first);
}

// Remembers the last path that it was given.
class RecordingSand final : public SandModel {
 public:
  std::string name() const override { return "recording"; }
  const Blade& blade() const override { return blade_; }
  const ToolPath& path() const { return path_; }

 protected:
  std::vector<Outcome> ApplyChecked(std::span<SandState> states,
                                    std::span<const ToolPath> paths) const override {
    path_ = paths[0];
    return std::vector<Outcome>(states.size());
  }

 private:
  Blade blade_;
  mutable ToolPath path_;
};

TEST(StepEpisodes, ATrackingErrorMovesTheExecutedStrokeAlone) {
  const RecordingSand sand;
  const EpisodeConfig config{.tracking_error_m = 0.002};
  double square_m2 = 0;
  constexpr int kStrokes = 60;
  auto episodes = Start(MakeTask(kStrokes + 1), config);
  for (int k = 0; k < kStrokes; ++k) {
    const auto result = StepEpisodes({.sand = sand}, config, episodes, kAction);
    const Eigen::Vector3d asked = result[0]->stroke.control_points_m.front();
    const BladePose& done = sand.path().front();
    square_m2 += std::pow(done.x_m - asked.x(), 2) + std::pow(done.y_m - asked.y(), 2) +
                 std::pow(done.z_m - asked.z(), 2);
    EXPECT_NEAR(asked.x(), 0.1, 1e-9);
  }
  // sd of a mean square of 180 draws: 10 %.
  EXPECT_NEAR(std::sqrt(square_m2 / (3 * kStrokes)), 0.002, 0.0003);
}

TEST(StartEpisode, MayStartWithPartOfTheBudgetGone) {
  const StillSand still;
  std::vector<EpisodeState> episodes = {StartEpisode(StillSand(), MakeTask(4), {}, RandomStream(1), 3)};
  EXPECT_EQ(View(episodes[0]).strokes_used, 3);
  StepEpisodes({.sand = still}, {}, episodes, kAction);
  EXPECT_TRUE(episodes[0].terminated);
  EXPECT_EQ(episodes[0].strokes(), 1);
  EXPECT_EQ(EpisodeMetrics(episodes[0], {}).at("success"), 0);
}

}  // namespace
}  // namespace sandwright
