#include "env/benchmark_tasks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "data/scan_folder.h"
#include "env/random_strokes.h"
#include "tests/support/shared_data.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

void ExpectSoundSet(const Benchmark& set, const std::string& name) {
  const TaskConfig config = BenchmarkConfig(name);
  EXPECT_EQ(set.id, name + "-1");
  ASSERT_EQ(set.tasks.size(), 100u);
  std::set<std::vector<float>> terrains;
  for (const Task& task : set.tasks) {
    CheckTask(task, name);
    EXPECT_EQ(task.terrain.rows, 30);
    EXPECT_EQ(task.terrain.columns, 30);
    EXPECT_EQ(task.terrain.datum, Datum::kFloor);
    EXPECT_EQ(task.max_strokes, config.max_strokes);
    const double error_m = GoalError(task.terrain, task.goal);
    EXPECT_GE(error_m, config.difficulty_low_m - 1e-6);
    EXPECT_LE(error_m, config.difficulty_high_m + 1e-6);
    const auto counted = std::ranges::count(task.goal.mask, 1);
    EXPECT_GE(counted, 900 * config.area_low * 0.95);  // sides are whole cells
    double difference_m = 0;
    CellRect place;
    for (int row = 0; row < 30; ++row) {
      for (int column = 0; column < 30; ++column) {
        if (!task.goal.mask[task.goal.Index(row, column)]) continue;
        difference_m += static_cast<double>(task.goal.At(row, column)) - task.terrain.At(row, column);
        place = Union(place, {row, column, row + 1, column + 1});
      }
    }
    EXPECT_NEAR(difference_m / static_cast<double>(counted), 0, 1e-7);
    // Not the whole map: the terrain around a goal's place may be steeper.
    EXPECT_EQ(place.rows() * place.columns(), counted);
    EXPECT_LT(SteepestFace(Crop(task.goal, place)), 0.52);  // 27 degrees and a corner on a grid
    terrains.insert(task.terrain.height_m);
  }
  EXPECT_EQ(terrains.size(), 100u);  // no two alike
}

// What every machine must find; heights to a micrometre, since mathematical libraries differ in the
// last bit.
struct Pinned {
  size_t task;
  double error_m, terrain_m, goal_m;  // heights of row 12, column 17
};

void ExpectPinned(const Benchmark& set, std::initializer_list<Pinned> pinned) {
  for (const Pinned& p : pinned) {
    const Task& task = set.tasks[p.task];
    EXPECT_NEAR(GoalError(task.terrain, task.goal), p.error_m, 1e-6) << p.task;
    EXPECT_NEAR(task.terrain.At(12, 17), p.terrain_m, 1e-6) << p.task;
    EXPECT_NEAR(task.goal.At(12, 17), p.goal_m, 1e-6) << p.task;
  }
}

TEST(BenchmarkTasks, EasyIsWhatItWas) {
  const Benchmark set = MakeBenchmark("easy", 2);
  ExpectSoundSet(set, "easy");
  EXPECT_EQ(TasksSha256(set.tasks), TasksSha256(MakeBenchmark("easy", 3).tasks));
  ExpectPinned(set, {{0, 0.0058861, 0.0385014, 0.0500000},
                     {57, 0.0045463, 0.0538657, 0.0433039},
                     {99, 0.0051205, 0.0558929, 0.0505108}});
}

TEST(BenchmarkTasks, HardIsWhatItWas) {
  const Benchmark set = MakeBenchmark("hard", 2);
  ExpectSoundSet(set, "hard");
  EXPECT_EQ(TasksSha256(set.tasks), TasksSha256(MakeBenchmark("hard", 3).tasks));
  ExpectPinned(set, {{0, 0.0081597, 0.0365632, 0.0415569},
                     {57, 0.0098040, 0.0416060, 0.0506805},
                     {99, 0.0065474, 0.0451442, 0.0398542}});
}

TEST(BenchmarkTasks, ScannedIsWhatItWas) {
  const Benchmark set = MakeBenchmark("scanned", 2);
  ExpectSoundSet(set, "scanned");
  ExpectPinned(set, {{0, 0.0072325, 0.0469456, 0.0495712},
                     {57, 0.0072712, 0.0313963, 0.0332835},
                     {99, 0.0099378, 0.0399576, 0.0443907}});
}

TEST(BenchmarkTasks, RealScansBecomeTasks) {
  const auto folder = SharedFile("data/scans");
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  const ScanFolder scans = ReadScanFolder(folder, {});
  EXPECT_THAT(scans.files, ::testing::Contains("terrain_01.npz"));
  EXPECT_THAT(scans.refusals, ::testing::Contains(HasSubstr("reject_not_sand.npz: the heights span")));
  const Benchmark set = MakeRealBenchmark(scans.maps);
  ExpectSoundSet(set, "real");
  EXPECT_EQ(TasksSha256(set.tasks), TasksSha256(MakeRealBenchmark(scans.maps).tasks));
}

TEST(BenchmarkTasks, FlatScansAndUnknownSetsAreRefused) {
  EXPECT_THAT([] { BenchmarkConfig("medium"); },
              ThrowsMessage<Error>(HasSubstr(
                  "task set \"medium\" is unknown; allowed: easy, hard, scanned, real")));
  const std::vector<HeightMap> small{HeightMap(20, 20, 0.01, 0.05f)};
  EXPECT_THAT([&] { MakeRealBenchmark(small); },
              ThrowsMessage<Error>(HasSubstr("no piece of 0.3 x 0.3 m of the 1 scans")));
}

TEST(ScanFolder, SaysWhatIsWrong) {
  const std::filesystem::path folder = ::testing::TempDir() + "scans";
  std::filesystem::remove_all(folder);
  EXPECT_THAT([&] { ReadScanFolder(folder, {}); },
              ThrowsMessage<Error>(HasSubstr("scans: no such folder")));
  std::filesystem::create_directories(folder);
  EXPECT_THAT([&] { ReadScanFolder(folder, {}); },
              ThrowsMessage<Error>(HasSubstr("none of 0 scans (.h5, .png, .npy, .npz) is accepted")));
  WriteHeightMap(HeightMap(40, 40, 0.01, 0.05f), folder / "b.h5");
  WriteNpy<float>(folder / "a.npy", std::vector<float>(100, 7.0f), {100});
  const ScanFolder found = ReadScanFolder(folder, {});
  EXPECT_EQ(found.files, std::vector<std::string>{"b.h5"});
  EXPECT_THAT(found.refusals, ::testing::ElementsAre(HasSubstr("a.npy: ")));
}

}  // namespace
}  // namespace sandwright
