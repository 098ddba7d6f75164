// What is foreseen: the interval, the reasons for misses, and the comparison afterwards.
#include "agents/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "agents/load_agent.h"
#include "data/base/error.h"
#include "data/base/random.h"
#include "data/shipped.h"
#include "data/task.h"
#include "env/heightfield.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class VerdictTest : public ::testing::Test {
 protected:
  VerdictTest() { goal_.mask.assign(goal_.size(), 1); }

  // In sand that does not move, so that the end is the start.
  Verdict OnStillSand() const {
    std::vector<std::unique_ptr<SandModel>> worlds;
    worlds.push_back(std::make_unique<StillSand>());
    worlds.push_back(std::make_unique<StillSand>());
    const auto agent = LoadAgent("sweep", {.model = *worlds[0], .gate = &gate_});
    const ShapingJob job{.terrain = terrain_, .goal = goal_, .region = {0, 0, 0.3, 0.3}, .max_strokes = 3};
    return MakeVerdict(*agent, *worlds[0], worlds, gate_, job, 1, config_);
  }
  MissReason At(const Verdict& verdict, int row, int column) const { return verdict.why[goal_.Index(row, column)]; }

  SafetyGate gate_{LoadWorkcell(ShippedConfig("workcell_small.yaml"))};
  VerdictConfig config_{.worlds = {"none", "none"}, .low_factor = 0.8, .high_factor = 1.5, .goal = {}};
  HeightMap terrain_{60, 60, 0.005, 0.05f}, goal_ = terrain_;
};

TEST(ErrorIntervalTest, IsTheRangeOfTheWorldsStretched) {
  const VerdictConfig config{.low_factor = 0.5, .high_factor = 2, .goal = {}};
  const ErrorInterval interval = IntervalOf(std::vector<double>{0.003, 0.002, 0.004}, config);
  EXPECT_DOUBLE_EQ(interval.expected_m, 0.003);
  EXPECT_DOUBLE_EQ(interval.low90_m, 0.001);
  EXPECT_DOUBLE_EQ(interval.high90_m, 0.008);
  EXPECT_TRUE(interval.holds(0.008));
  EXPECT_FALSE(interval.holds(0.0009));
}

TEST(ErrorAsScannedTest, WhatIsSmoothedInAModelIsRoughInTheSand) {
  constexpr double kRoughness_m = 0.002;
  HeightMap scan(60, 60, 0.005, 0.06f);
  RandomStream stream(1);
  for (float& h : scan.height_m) h += static_cast<float>(kRoughness_m * stream.Normal());
  HeightMap goal(60, 60, 0.005, 0.05f);
  goal.mask.assign(goal.size(), 1);
  EXPECT_DOUBLE_EQ(ErrorAsScanned(scan, scan, goal), GoalError(scan, goal));  // untouched: as it is
  HeightMap levelled = goal;
  levelled.mask.clear();
  // The blur takes 5 % of white noise with it.
  EXPECT_NEAR(ErrorAsScanned(scan, levelled, goal), 0.95 * std::sqrt(2 / std::numbers::pi) * kRoughness_m, 5e-5);
  const HeightMap smooth_scan(60, 60, 0.005, 0.053f);
  EXPECT_NEAR(ErrorAsScanned(smooth_scan, levelled, goal), 0, 1e-8);  // fine sand stays smooth
}

TEST_F(VerdictTest, SandThatIsMissingIsSaidToBeMissing) {
  for (float& h : goal_.height_m) h += 0.005f;
  const Verdict verdict = OnStillSand();
  EXPECT_NEAR(verdict.error.expected_m, 0.005, 1e-6);
  EXPECT_NEAR(verdict.error.low90_m, 0.004, 1e-6);
  EXPECT_NEAR(verdict.error.high90_m, 0.0075, 1e-6);
  EXPECT_NEAR(verdict.goal.volume_missing_m3, 0.005 * 0.3 * 0.3, 1e-8);
  EXPECT_EQ(At(verdict, 30, 30), MissReason::kVolume);
}

TEST_F(VerdictTest, CliffsMissForTheirSlopeAndTheRestForStrokes) {
  for (int row = 0; row < goal_.rows; ++row) {
    for (int column = 0; column < goal_.columns; ++column) goal_.At(row, column) += column < 30 ? 0.01f : -0.01f;
  }
  goal_.mask[goal_.Index(2, 2)] = 0;
  const Verdict verdict = OnStillSand();
  EXPECT_EQ(At(verdict, 30, 29), MissReason::kSlope);
  EXPECT_EQ(At(verdict, 30, 30), MissReason::kSlope);
  EXPECT_EQ(At(verdict, 2, 2), MissReason::kNotCounted);
  // Where the walls let no stroke start, that comes first.
  const bool reached = gate_.reach().At(15.5 * 0.005, 30.5 * 0.005) > 0;
  EXPECT_EQ(At(verdict, 30, 15), reached ? MissReason::kStrokes : MissReason::kReach);
  const auto json = ToJson(verdict, goal_, config_);
  double of_error_mm = 0;
  for (const auto& [reason, miss] : json["misses"].items()) of_error_mm += miss["of_error_mm"].get<double>();
  EXPECT_NEAR(of_error_mm, json["expected_error_mm"].get<double>(), 1e-6);  // all that is missed has a reason
}

TEST_F(VerdictTest, CountsStrokesAndTheArmsTime) {
  for (int column = 20; column < 40; ++column) goal_.At(30, column) += 0.02f;
  const Verdict verdict = OnStillSand();
  ASSERT_EQ(verdict.worlds.size(), 2u);
  EXPECT_EQ(verdict.strokes, verdict.worlds[0].strokes);
  const int done = verdict.worlds[0].strokes - verdict.worlds[0].rejected;
  EXPECT_GE(verdict.arm_s, done * config_.look_s);
  EXPECT_LT(verdict.arm_s, 60 * std::max(done, 1));
  config_.look_s += 10;
  EXPECT_NEAR(OnStillSand().arm_s, verdict.arm_s + 10 * done, 1e-9);
}

TEST_F(VerdictTest, TheOutcomeIsInsideOrNotAndOfThisGoal) {
  for (float& h : goal_.height_m) h += 0.005f;
  const nlohmann::json json = ToJson(OnStillSand(), goal_, config_);
  EXPECT_EQ(CompareWithVerdict(json, goal_, 0.0045)["inside"], true);
  EXPECT_EQ(CompareWithVerdict(json, goal_, 0.008)["inside"], false);
  EXPECT_THAT([&] { CompareWithVerdict(json, terrain_, 0.0045); }, ThrowsMessage<Error>(HasSubstr("another goal")));
  EXPECT_THAT([&] { CompareWithVerdict({{"strokes", 3}}, goal_, 0.0045); },
              ThrowsMessage<Error>(HasSubstr("the verdict has no goal_id")));
}

TEST_F(VerdictTest, ThePictureShowsTheReasons) {
  for (float& h : goal_.height_m) h += 0.005f;
  const cv::Mat picture = DrawVerdict(OnStillSand(), terrain_, goal_);
  EXPECT_GT(picture.cols, 3 * 300);
  EXPECT_EQ(picture.type(), CV_8UC3);
}

}  // namespace
}  // namespace sandwright
