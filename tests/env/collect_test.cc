#include "env/collect.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "data/base/atomic_file.h"
#include "data/base/process.h"
#include "data/stroke_dataset.h"

namespace sandwright {
namespace {

class CollectTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("sandwright_") +
               testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    config_.width_m = 0.25;
    config_.depth_m = 0.2;
    config_.cell_size_m = 0.01;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  CollectRequest Request(const std::string& out, int64_t strokes, int64_t sequence) const {
    return {folder_ / out, strokes, sequence, 42, 1};
  }
  std::string ErrorOf(const CollectRequest& request) const {
    try {
      Collect(config_, request);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  }

  std::filesystem::path folder_;
  CollectConfig config_;
};

TEST_F(CollectTest, StrokesOfABedFollowEachOther) {
  const Collected collected = Collect(config_, Request("beds", 7, 3));
  EXPECT_EQ(collected.strokes, 7);
  const auto files = FindStrokeFiles({(folder_ / "beds").string()});
  ASSERT_EQ(files.size(), 3u);
  std::vector<std::string> beds;
  for (const auto& file : files) {
    const StrokeFile content = ReadStrokeFile(file);
    EXPECT_EQ(content.source, "heightfield");
    EXPECT_EQ(content.strokes.size(), beds.size() < 2 ? 3u : 1u);
    for (size_t i = 0; i < content.strokes.size(); ++i) {
      const StrokeRecord& record = content.strokes[i];
      EXPECT_EQ(record.step, static_cast<int64_t>(i));
      EXPECT_EQ(record.sequence, static_cast<int64_t>(beds.size()));
      if (i > 0) {
        EXPECT_EQ(record.before.height_m, content.strokes[i - 1].after.height_m);
      }
    }
    beds.push_back(content.bed);
  }
  EXPECT_NE(beds[0], beds[1]);
}

// Ctrl-C after some strokes, then a second call: the same bytes as without it, for any threads.
TEST_F(CollectTest, ContinuesWhatWasStopped) {
  Collect(config_, Request("whole", 10, 4));
  int asked = 0;
  const Collected stopped = Collect(config_, Request("halves", 10, 4), [&] { return ++asked > 6; });
  EXPECT_EQ(stopped.strokes, 6);
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // no file may hold a time
  CollectRequest rest = Request("halves", 10, 4);
  rest.threads = 3;
  const Collected finished = Collect(config_, rest);
  EXPECT_EQ(finished.strokes, 10);
  EXPECT_EQ(finished.added, 4);
  for (const char* name : {"bed_00000.h5", "bed_00001.h5", "bed_00002.h5"})
    EXPECT_EQ(ReadFile(folder_ / "whole" / name), ReadFile(folder_ / "halves" / name)) << name;
  EXPECT_EQ(Collect(config_, rest).added, 0);
}

TEST_F(CollectTest, OneFileHoldsOneBed) {
  EXPECT_EQ(Collect(config_, Request("one.h5", 3, 3)).added, 3);
  EXPECT_EQ(Collect(config_, Request("one.h5", 5, 5)).added, 2);
  EXPECT_EQ(ReadStrokeFile(folder_ / "one.h5").strokes.size(), 5u);
  EXPECT_NE(ErrorOf(Request("one.h5", 6, 3)).find("one file holds one bed"), std::string::npos);
}

TEST_F(CollectTest, RefusesWhatItCannotContinue) {
  Collect(config_, Request("one.h5", 1, 1));
  CollectRequest other = Request("one.h5", 2, 2);
  other.seed = 43;
  EXPECT_NE(ErrorOf(other).find("it holds strokes of other settings"), std::string::npos);
  config_.heightfield.repose_deg = 30;
  EXPECT_NE(ErrorOf(Request("one.h5", 2, 2)).find("it holds strokes of other settings"),
            std::string::npos);
  WriteFileAtomically(folder_ / "foreign.h5", "not HDF5");
  EXPECT_NE(ErrorOf(Request("foreign.h5", 1, 1)).find("not an HDF5 file"), std::string::npos);
  EXPECT_NE(ErrorOf(Request("one.h5", 0, 1)).find("strokes = 0"), std::string::npos);
  config_.width_m = 0.123456;
  EXPECT_NE(ErrorOf(Request("new.h5", 1, 1)).find("whole number of cells"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "new.h5"));
  config_.width_m = 0.25;
  EXPECT_NE(ErrorOf({"/no/such/folder/new.h5", 1, 1, 42, 1}), "");
}

// A bed of grains goes on from the grains that it keeps beside it while it is not finished.
TEST_F(CollectTest, GrainsContinueToTheSameBytes) {
  if (!FindProgram("lmp")) GTEST_SKIP() << "LAMMPS is not installed";
  config_.width_m = 0.12;
  config_.depth_m = 0.1;
  config_.cell_size_m = 0.004;
  config_.terrain.mean_depth_m = 0.04;
  config_.terrain.amplitude_m = 0.001;
  config_.excavation = {
      .wall_margin_m = 0.03, .floor_margin_m = 0.025, .deepest_m = 0.012, .shortest_m = 0.02};
  config_.dem.reach_m = 0.04;
  config_.dem.cache = folder_ / "cache";
  CollectRequest request = Request("whole.h5", 2, 2);
  request.source = "dem";
  Collect(config_, request);
  const auto hidden = [&] {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_))
      count += entry.path().filename().string().starts_with(".");
    return count;
  };
  EXPECT_EQ(hidden(), 0) << "a finished bed keeps no grains";

  request.out = folder_ / "parts.h5";
  int asked = 0;
  Collect(config_, request, [&] { return ++asked > 1; });  // stopped after one stroke
  EXPECT_EQ(ReadStrokeFile(request.out).strokes.size(), 1u);
  EXPECT_EQ(hidden(), 1);
  Collect(config_, request);
  EXPECT_EQ(hidden(), 0);
  EXPECT_EQ(ReadFile(folder_ / "parts.h5"), ReadFile(folder_ / "whole.h5"));

  const StrokeFile content = ReadStrokeFile(request.out);
  EXPECT_EQ(content.source, "dem");
  EXPECT_EQ(content.strokes[1].before.height_m, content.strokes[0].after.height_m);
  request.strokes = request.sequence = 3;
  EXPECT_NE(ErrorOf(request).find("choose another --out"), std::string::npos);
}

TEST_F(CollectTest, PackingsAreForGrains) {
  config_.packings = 3;
  EXPECT_NE(ErrorOf(Request("beds", 3, 3)).find("packings = 3; only grains"), std::string::npos);
}

}  // namespace
}  // namespace sandwright
