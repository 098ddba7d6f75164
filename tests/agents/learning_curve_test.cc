#include "agents/learning_curve.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data/base/atomic_file.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

TEST(InterquartileMean, HandNumbers) {
  EXPECT_DOUBLE_EQ(InterquartileMean({7}), 7);
  EXPECT_DOUBLE_EQ(InterquartileMean({100, 2, -50, 3}), 2.5);
  // A quarter of three values is 0.75 of one: (0.25 x 0 + 1 + 0.25 x 5) / 1.5.
  EXPECT_DOUBLE_EQ(InterquartileMean({5, 0, 1}), 1.5);
}

std::filesystem::path RunFolder(const std::string& name, const std::string& rows) {
  const auto folder = std::filesystem::path(::testing::TempDir()) / "learning_curve_test" / name;
  std::filesystem::create_directories(folder);
  WriteFileAtomically(folder / "progress.csv", "time/total_timesteps,loss,eval/error\n" + rows);
  return folder;
}

TEST(LearningCurve, IsTakenWhereAllRunsHaveAValue) {
  const std::vector<std::filesystem::path> runs = {
      RunFolder("a", "10,1,4\n20,1,\n30,1,2\n40,1,1\n"),
      RunFolder("b", "10,1,6\n20,1,5\n30,1,4\n")};
  const LearningCurve curve = ReadLearningCurve(runs, "eval/error", 1);
  EXPECT_EQ(curve.runs, 2);
  EXPECT_EQ(curve.steps, (std::vector<double>{10, 30}));
  EXPECT_EQ(curve.iqm, (std::vector<double>{5, 3}));
  // Two runs: the resamples are {a, a}, {a, b}, {b, b}.
  EXPECT_EQ(curve.low95, (std::vector<double>{4, 2}));
  EXPECT_EQ(curve.high95, (std::vector<double>{6, 4}));
}

TEST(LearningCurve, WhatIsMissingIsNamed) {
  const auto folder = RunFolder("c", "10,1,4\n");
  const auto message = [](const std::vector<std::filesystem::path>& runs, const char* column) {
    try {
      ReadLearningCurve(runs, column, 1);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_THAT(message({folder}, "eval/eror"), ::testing::HasSubstr("no column \"eval/eror\""));
  EXPECT_THAT(message({folder / "none"}, "loss"), ::testing::HasSubstr("none"));
  EXPECT_THAT(message({folder, RunFolder("d", "20,1,4\n")}, "loss"),
              ::testing::HasSubstr("no step that all 2 runs share"));
  EXPECT_THAT(message({RunFolder("e", "10,x,4\n")}, "loss"), ::testing::HasSubstr("10,x,4"));
}

}  // namespace
}  // namespace sandwright
