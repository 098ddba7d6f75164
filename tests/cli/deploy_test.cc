// From a plan to the simulated arm and back out of its log, as a user meets it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "data/base/atomic_file.h"
#include "data/height_map.h"
#include "data/stroke_dataset.h"
#include "tests/support/program.h"

namespace sandwright {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Field;
using ::testing::HasSubstr;

constexpr const char* kWorkcell = SANDWRIGHT_ROOT "/configs/workcell_small.yaml";

class DeployTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("deploy_" +
               std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    WriteHeightMap(HeightMap(60, 60, 0.005, 0.05f), folder_ / "bed.h5");
    WritePlan(2);
  }
  void WritePlan(int strokes) const {
    std::string text = "schema: sandwright-plan\nschema_version: 1\nframe: box\nstrokes:\n";
    for (int i = 0; i < strokes; ++i) {
      const std::string y = std::to_string(0.1 + 0.1 * i / strokes);
      text += "  - control_points_m: [[0.1, " + y + ", 0.035], [0.2, " + y +
              ", 0.04]]\n    degree: 1\n    speed_mps: 0.1\n";
    }
    WriteFileAtomically(folder_ / "plan.yaml", text);
  }
  // In the test's folder; SANDWRIGHT_PROGRAM comes from CMake.
  Finished Invoke(const std::string& arguments, const std::string& before = "") const {
    return Shell("cd " + folder_.string() + " && " + before + SANDWRIGHT_PROGRAM " " + arguments);
  }
  Finished Seal() const {
    return Invoke("check --seal --plan plan.yaml --terrain bed.h5 --workcell " +
                  std::string(kWorkcell));
  }
  Finished Deploy(const std::string& more, const std::string& before = "") const {
    return Invoke("deploy --plan plan.yaml --terrain bed.h5 --workcell " + std::string(kWorkcell) +
                      " " + more,
                  before);
  }
  size_t StrokesOnFile() const { return ReadStrokeFile(folder_ / "log/strokes.h5").strokes.size(); }

  fs::path folder_;
};

auto Refusal(const std::string& text) {
  return AllOf(Field(&Finished::exit_code, 3), Field(&Finished::output, HasSubstr(text)));
}
auto BadInput(const std::string& text) {
  return AllOf(Field(&Finished::exit_code, 2), Field(&Finished::output, HasSubstr(text)));
}

TEST_F(DeployTest, SealedPlanRunsAndIsShownAgain) {
  EXPECT_THAT(Deploy("--mode run --log log"), Refusal("not sealed"));
  EXPECT_FALSE(fs::exists(folder_ / "log"));
  ASSERT_EQ(Seal().exit_code, 0);
  EXPECT_EQ(Deploy("--mode preview --picture preview.png").exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "preview.png"));
  EXPECT_EQ(Deploy("--mode dry-run --log dry").exit_code, 0);
  const Finished run = Deploy("--mode run --log log --json run.json");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const auto result = nlohmann::json::parse(ReadFile(folder_ / "run.json"));
  EXPECT_EQ(result["end"], "done");
  EXPECT_EQ(result["strokes"].size(), 2u);
  EXPECT_EQ(result["strokes"][0]["rescan"]["verdict"], "accept");
  EXPECT_EQ(StrokesOnFile(), 2u);
  const Finished replay = Invoke("deploy --replay log --json replay.json");
  EXPECT_EQ(replay.exit_code, 0);
  EXPECT_THAT(replay.output, HasSubstr("verdict"));
  EXPECT_EQ(nlohmann::json::parse(ReadFile(folder_ / "replay.json"))["strokes"], 2);
  EXPECT_THAT(Deploy("--mode run --log log"), BadInput("holds a log"));
}

TEST_F(DeployTest, ChangedPlanIsRefusedSealOrNoSeal) {
  ASSERT_EQ(Seal().exit_code, 0);
  std::string text = ReadFile(folder_ / "plan.yaml");
  text.replace(text.find("0.035"), 5, "0.034");
  WriteFileAtomically(folder_ / "plan.yaml", text);
  EXPECT_THAT(Deploy("--mode run --log log"), Refusal("edited since it was sealed"));
  text.replace(text.find("0.034"), 5, "-0.04");
  WriteFileAtomically(folder_ / "plan.yaml", text);
  EXPECT_THAT(Seal(), Refusal("below the box floor"));
  EXPECT_FALSE(fs::exists(folder_ / "log"));
}

TEST_F(DeployTest, NobodyThereMeansNo) {
  ASSERT_EQ(Seal().exit_code, 0);
  EXPECT_THAT(Deploy("--log log < /dev/null"), Refusal("not confirmed"));
  EXPECT_FALSE(fs::exists(folder_ / "log/strokes.h5"));
}

TEST_F(DeployTest, InterruptedRunGoesOnWithANewScan) {
  WritePlan(6);
  ASSERT_EQ(Seal().exit_code, 0);
  const Finished cut = Deploy("--mode run --log log", "timeout -s INT 2 ");
  ASSERT_THAT(cut.exit_code, ::testing::AnyOf(130, 124)) << cut.output;
  const size_t before = fs::exists(folder_ / "log/strokes.h5") ? StrokesOnFile() : 0;
  EXPECT_LT(before, 6u);
  const Finished rest = Invoke("deploy --resume log --json rest.json");
  ASSERT_EQ(rest.exit_code, 0) << rest.output;
  EXPECT_GE(StrokesOnFile(), 5u);  // the one that was begun when it was cut is not sent again
}

TEST_F(DeployTest, WhatIsMissingIsNamed) {
  EXPECT_THAT(Deploy("--mode run"), BadInput("needs --log DIR"));
  EXPECT_THAT(Invoke("deploy --agent greedy --log log"), BadInput("--agent needs --goal"));
  EXPECT_THAT(Invoke("deploy --log log"), BadInput("either --plan FILE or --agent"));
  EXPECT_THAT(Invoke("deploy --replay nowhere"), BadInput("holds no log"));
  EXPECT_THAT(Invoke("deploy --resume nowhere"), BadInput("holds no log"));
  ASSERT_EQ(Seal().exit_code, 0);
  // A real arm needs a calibrated cell, and the shipped one is nobody's.
  EXPECT_THAT(Deploy("--mode run --log log --arm 127.0.0.1"), Refusal("box: never calibrated"));
}

TEST_F(DeployTest, CollectOnTheSimulatedArmGoesOnWhereItWas) {
  const std::string collect = "collect --source simulated --seed 4 --out log --workcell " +
                              std::string(kWorkcell) + " --strokes ";
  ASSERT_EQ(Invoke(collect + "1").exit_code, 0);
  EXPECT_EQ(StrokesOnFile(), 1u);
  ASSERT_EQ(Invoke(collect + "2").exit_code, 0);
  const StrokeFile file = ReadStrokeFile(folder_ / "log/strokes.h5");
  ASSERT_EQ(file.strokes.size(), 2u);
  EXPECT_EQ(file.source, "simulated");
  EXPECT_NE(file.strokes[0].stroke.control_points_m, file.strokes[1].stroke.control_points_m);
  EXPECT_THAT(Invoke("collect --source rig --out rig --strokes 1"), BadInput("--arm HOST"));
}

// What was foreseen before anything moved, and how it came out.
TEST_F(DeployTest, TheEndIsComparedWithTheVerdict) {
  const std::string cell = " --workcell " + std::string(kWorkcell);
  ASSERT_EQ(Invoke("goal --shape mound --rise-mm 10 --terrain bed.h5 --out goal.h5").exit_code, 0);
  ASSERT_EQ(Invoke("goal --shape crater --rise-mm 10 --terrain bed.h5 --out other.h5").exit_code, 0);
  const std::string agent = " --agent greedy --goal goal.h5 --max-strokes 2" + cell;
  const Finished planned =
      Invoke("plan --terrain bed.h5 --out mine.yaml --verdict verdict.json" + agent + " greedy.evaluations=20");
  ASSERT_EQ(planned.exit_code, 0) << planned.output;
  EXPECT_THAT(planned.output, HasSubstr("nine of ten"));
  const auto verdict = nlohmann::json::parse(ReadFile(folder_ / "verdict.json"));
  EXPECT_LT(verdict["low90_mm"], verdict["high90_mm"]);
  EXPECT_GT(verdict["arm_minutes"], 0);
  EXPECT_EQ(verdict["worlds"].size(), 1u);  // the surrogates work on cells of 4 mm
  EXPECT_TRUE(fs::exists(folder_ / "verdict.png"));
  const Finished run = Invoke("deploy --mode simulate --terrain bed.h5 --log log --verdict verdict.json --json run.json" +
                              agent + " greedy.evaluations=20");
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const auto outcome = nlohmann::json::parse(ReadFile(folder_ / "run.json"))["verdict"];
  const double end_mm = outcome["in_goal_mean_diff_mm"];
  EXPECT_EQ(outcome["inside"], end_mm >= outcome["low90_mm"] && end_mm <= outcome["high90_mm"]);
  EXPECT_THAT(run.output, HasSubstr("that were foreseen"));
  EXPECT_THAT(ReadFile(folder_ / "log/events.jsonl"), HasSubstr("\"outcome\""));
  EXPECT_THAT(Invoke("deploy --mode simulate --terrain bed.h5 --log log2 --verdict verdict.json --agent greedy --goal "
                     "other.h5" + cell),
              BadInput("made for another goal"));
}

}  // namespace
}  // namespace sandwright
