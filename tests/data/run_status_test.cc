#include "data/base/run_status.h"

#include <gtest/gtest.h>

#include <thread>

#include "data/base/error.h"
#include "data/base/progress.h"

namespace sandwright {
namespace {

class RunStatusTest : public ::testing::Test {
 protected:
  std::vector<RunReport> seen_;
  RunStatus status_{"fit", [this](const RunReport& report) { seen_.push_back(report); }};
};

TEST_F(RunStatusTest, FirstStepAndEndAreShownAndSeldomMore) {
  status_.Figures({{"rmse_mm", 2.0}});
  status_.Advance(1, 100, "epochs");
  for (int done = 2; done <= 50; ++done) status_.Advance(done, 100, "epochs", "better");
  ASSERT_EQ(seen_.size(), 1u);
  EXPECT_EQ(seen_[0].ToJson()["state"], "running");
  EXPECT_EQ(seen_[0].ToJson()["figures"]["rmse_mm"], 2.0);
  status_.Warn("a lamp is out");
  status_.End(RunState::kStopped, "stopped by the user");
  ASSERT_EQ(seen_.size(), 2u);
  const nlohmann::json json = seen_[1].ToJson();
  EXPECT_EQ(json["state"], "stopped");
  EXPECT_EQ(json["text"], "stopped by the user");
  EXPECT_EQ(json["done"], 50);
  EXPECT_EQ(json["note"], "better");
  EXPECT_EQ(json["last_warning"], "a lamp is out");
  EXPECT_GT(json["rate_per_s"], 0);
  EXPECT_TRUE(json["left_s"].is_null());
  EXPECT_EQ(json["began"].get<std::string>().size(), std::string("2024-05-01T12:00:00.000Z").size());
}

// Another run's files must not be replaced by one that was refused before its first step.
TEST_F(RunStatusTest, RunWithoutAStepLeavesNoTrace) {
  status_.Warn("no such file");
  status_.End(RunState::kFailed, "no such file");
  EXPECT_TRUE(seen_.empty());
}

TEST_F(RunStatusTest, ProgressTellsIt) {
  Progress progress("fit", 10, "epochs", &status_);
  progress.Update(3, "note");
  ASSERT_EQ(seen_.size(), 1u);
  EXPECT_EQ(seen_[0].done, 3);
  EXPECT_EQ(seen_[0].total, 10);
  EXPECT_EQ(seen_[0].unit, "epochs");
  EXPECT_EQ(seen_[0].note, "note");
}

TEST(RunStatus, WhatCannotBeShownEndsNoRun) {
  RunStatus status("fit", [](const RunReport&) { throw Error("the disk is full"); });
  EXPECT_NO_THROW(status.Advance(1, 2, "epochs"));
  EXPECT_NO_THROW(status.End(RunState::kDone, ""));
}

TEST(Pace, CountsFromWhereAContinuedJobBegan) {
  Pace pace;
  EXPECT_FALSE(pace.left_s(10).has_value());
  pace.Update(1001);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_LE(pace.rate_per_s(), 1 / 0.02);
  EXPECT_GT(pace.left_s(1002).value(), 0);
  EXPECT_FALSE(pace.left_s(1001).has_value());
}

}  // namespace
}  // namespace sandwright
