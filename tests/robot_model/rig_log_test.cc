// The log of a rig is on disk before the arm moves, and survives whatever comes.
#include "robot_model/rig_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include <fstream>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "robot_model/safety_gate.h"
#include "tests/support/random_strokes.h"

namespace sandwright {
namespace {

namespace fs = std::filesystem;

const fs::path kLog = fs::path(::testing::TempDir()) / "log";

// Counts what reaches the arm.
class CountingRig final : public Rig {
 public:
  std::string name() const override { return "counting"; }
  JointAngles Joints() override { return Workcell{}.home(); }
  Execution Execute(const GatedMotion& motion, const ExecuteOptions&) override {
    ++moved;
    ArmRecord record;
    record.time_s = {0};
    record.commanded = record.measured = {motion.end()};
    record.speed_radps = {Vector6::Zero()};
    return {.finished = true, .end = "finished", .record = record};
  }
  DepthView Look() override { return {std::vector<DepthFrame>(3), Eigen::Isometry3d::Identity()}; }
  int moved = 0;
};

class Log : public ::testing::Test {
 protected:
  Log() { fs::remove_all(kLog); }
  GatedMotion Motion() const {
    return *gate_.PassTransfer(cell_.camera_pose(), terrain_, cell_.home()).motion;
  }

  Workcell cell_;
  HeightMap terrain_{80, 120, 0.01, 0.05f};
  SafetyGate gate_{cell_};
  CountingRig rig_;
};

TEST_F(Log, TellsTheIntentionAndTheOutcome) {
  RigLog log(kLog, false);
  LoggedRig logged(rig_, log);
  EXPECT_TRUE(logged.Execute(Motion(), {}).finished);
  EXPECT_EQ(logged.Look().frames.size(), 3u);
  ScanResult dark;
  dark.reasons = {"dark"};
  log.AddScan(dark);
  const auto events = RigLog::ReadEvents(kLog);
  ASSERT_EQ(events.size(), 4u);
  EXPECT_EQ(events[0]["event"], "motion");
  EXPECT_EQ(events[0]["kind"], "transfer");
  EXPECT_EQ(events[1]["event"], "moved");
  EXPECT_EQ(events[1]["end"], "finished");
  EXPECT_EQ(events[2]["frames"], 3);
  EXPECT_EQ(events[3]["reasons"][0], "dark");
  EXPECT_THAT(ReadFile(kLog / events[1]["file"].get<std::string>()),
              ::testing::StartsWith("time_s,commanded_1_rad"));
}

TEST_F(Log, FullDiskStopsBeforeTheArmMoves) {
  RigLog log(kLog, false);
  LoggedRig logged(rig_, log);
  log.Add("begin");
  signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit full = before;
  full.rlim_cur = fs::file_size(kLog / "events.jsonl") + 10;
  setrlimit(RLIMIT_FSIZE, &full);
  EXPECT_THROW(logged.Execute(Motion(), {}), Error);
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(rig_.moved, 0);
}

TEST_F(Log, HalfALineIsDroppedAndGoneOnFrom) {
  { RigLog(kLog, false).Add("begin", {{"arm", "simulated"}}); }
  std::ofstream(kLog / "events.jsonl", std::ios::app) << "{\"event\":\"mot";
  EXPECT_EQ(RigLog::ReadEvents(kLog).size(), 1u);
  { RigLog(kLog, true).Add("resume"); }
  const auto events = RigLog::ReadEvents(kLog);
  ASSERT_EQ(events.size(), 2u);
  EXPECT_EQ(events[1]["event"], "resume");
}

// Killed before its first event: nothing has moved, so it begins as if nothing were there.
TEST_F(Log, LogWithoutAnEventIsNone) {
  fs::create_directories(kLog);
  std::ofstream(kLog / "events.jsonl") << "{\"event\":\"beg";
  EXPECT_FALSE(RigLog::Exists(kLog));
  EXPECT_THROW(RigLog(kLog, true), Error);
  { RigLog(kLog, false).Add("begin"); }
  EXPECT_TRUE(RigLog::Exists(kLog));
  EXPECT_EQ(RigLog::ReadEvents(kLog).size(), 1u);
  EXPECT_THROW(RigLog(kLog, false), Error);
}

TEST_F(Log, KeepsStrokesAsData) {
  RigLog log(kLog, false);
  StrokeRecord record;
  record.before = record.after = terrain_;
  record.stroke = TypicalStroke(0.6, 0.4, 0);
  record.path = SamplePath(record.stroke, 0.005);
  for (int i = 0; i < 2; ++i) log.AddStroke({"rig", "a bed", 0, "{}", {}, {}}, record);
  const StrokeFile file = ReadStrokeFile(kLog / "strokes.h5");
  ASSERT_EQ(file.strokes.size(), 2u);
  EXPECT_EQ(file.strokes[1].step, 1);
  EXPECT_TRUE(file.strokes[1].time.has_value());
  log.Add("begin");
  RigLog(kLog, true).AddStroke({"rig", "a bed", 0, "{}", {}, {}}, record);  // a sequence of its own
  const StrokeRecord next = ReadStrokeFile(kLog / "strokes.h5").strokes.at(2);
  EXPECT_EQ(next.sequence, 1);
  EXPECT_EQ(next.step, 0);
}

TEST_F(Log, FolderInTheOtherStateIsRefused) {
  EXPECT_THROW(RigLog(kLog, true), Error);
  { RigLog log(kLog, false); log.Add("begin"); }
  EXPECT_THROW(RigLog(kLog, false), Error);
  EXPECT_THROW(RigLog::ReadEvents("nowhere"), Error);
  WriteFileAtomically(kLog / "events.jsonl", "no event\n{}\n");
  EXPECT_THROW(RigLog::ReadEvents(kLog), Error);
}

}  // namespace
}  // namespace sandwright
