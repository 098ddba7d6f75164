#include "data/height_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "data/base/atomic_file.h"
#include "data/base/hdf5.h"
#include "data/task.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;

auto Fails(const std::string& text) {
  return ::testing::Throws<Error>(::testing::Property(&Error::what, HasSubstr(text)));
}
std::string Temp(const std::string& name) { return ::testing::TempDir() + "height_map_" + name; }

// h = x + 2 y at the cell centres.
HeightMap Plane(int rows, int columns, double cell_size_m) {
  HeightMap map(rows, columns, cell_size_m);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i)
      map.At(j, i) = static_cast<float>((i + 0.5) * cell_size_m + 2 * (j + 0.5) * cell_size_m);
  }
  return map;
}

TEST(HeightMapTest, BilinearHeightIsExactOnAPlaneAndHeldOutside) {
  const HeightMap map = Plane(4, 6, 0.01);
  EXPECT_NEAR(HeightAt(map, 0.023, 0.017), 0.023 + 2 * 0.017, 1e-7);
  EXPECT_NEAR(HeightAt(map, -1, 0.005), map.At(0, 0), 1e-7);
  EXPECT_NEAR(HeightAt(map, 9, 9), map.At(3, 5), 1e-7);
}

TEST(HeightMapTest, ResampleKeepsVolumeBothWays) {
  HeightMap map = Plane(6, 12, 0.005);
  map.At(2, 3) += 0.04f;
  const auto volume = [](const HeightMap& m) {
    return std::accumulate(m.height_m.begin(), m.height_m.end(), 0.0) * m.cell_size_m *
           m.cell_size_m;
  };
  for (double cell : {0.0025, 0.01, 0.015, 0.0075}) {
    const HeightMap other = Resample(map, cell);
    EXPECT_NEAR(volume(other) / volume(map), 1, 1e-6) << cell;
    EXPECT_NEAR(other.width_m(), map.width_m(), 1e-12);
  }
  EXPECT_THAT([&] { Resample(map, 0.007); }, Fails("0.007 does not divide"));
}

TEST(HeightMapTest, SamplesOntoCellsOfAnySize) {
  const HeightMap map = Plane(20, 30, 0.0038);
  const HeightMap piece = SampleOnto(map, 0.02, 0.03, 3, 5, 0.01);
  EXPECT_EQ(piece.rows, 3);
  for (int row = 0; row < 3; ++row)  // the mean over a cell of a plane is its middle
    for (int column = 0; column < 5; ++column)
      EXPECT_NEAR(piece.At(row, column),
                  0.02 + (column + 0.5) * 0.01 + 2 * (0.03 + (row + 0.5) * 0.01), 1e-6);
}

TEST(HeightMapTest, CropAndPasteAreInverse) {
  const HeightMap map = Plane(5, 7, 0.01);
  const CellRect rect{1, 2, 4, 6};
  const HeightMap patch = Crop(map, rect);
  EXPECT_EQ(patch.rows, 3);
  EXPECT_EQ(patch.At(0, 0), map.At(1, 2));
  HeightMap copy(5, 7, 0.01);
  Paste(patch, rect, copy);
  EXPECT_EQ(copy.At(3, 5), map.At(3, 5));
  EXPECT_EQ(copy.At(0, 0), 0);
}

TEST(HeightMapTest, FilesRoundTripExactly) {
  HeightMap map = Plane(3, 4, 0.004);
  map.datum = Datum::kRelative;
  map.valid.assign(map.size(), 1);
  map.valid[5] = 0;
  WriteHeightMap(map, Temp("a.h5"));
  const HeightMap back = ReadHeightMap(Temp("a.h5"));
  EXPECT_EQ(back.height_m, map.height_m);
  EXPECT_EQ(back.valid, map.valid);
  EXPECT_EQ(back.cell_size_m, map.cell_size_m);
  EXPECT_EQ(back.datum, Datum::kRelative);
}

TEST(HeightMapTest, BadMapsAreNamed) {
  HeightMap map = Plane(3, 4, 0.004);
  map.At(1, 2) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT([&] { WriteHeightMap(map, Temp("nan.h5")); }, Fails("row 1, column 2 is nan"));
  EXPECT_FALSE(std::filesystem::exists(Temp("nan.h5")));
  map.At(1, 2) = std::numeric_limits<float>::infinity();
  EXPECT_THAT([&] { CheckHeightMap(map, "m"); }, Fails("is inf"));
  EXPECT_THAT([&] { CheckHeightMap(HeightMap(1, 1, 0.01), "tiny"); },
              Fails("tiny: the map has 1 x 1"));
  EXPECT_THAT([&] { CheckHeightMap(HeightMap(2, 2, 0), "cell"); }, Fails("cell_size_m = 0"));
}

TEST(HeightMapTest, ForeignFilesAreRefusedByName) {
  EXPECT_THAT([&] { ReadHeightMap("missing.h5"); }, Fails("missing.h5: no such file"));
  WriteFileAtomically(Temp("text.h5"), "this is not HDF5");
  EXPECT_THAT([&] { ReadHeightMap(Temp("text.h5")); }, Fails("not an HDF5 file, or cut off"));
  WriteHeightMap(Plane(30, 40, 0.004), Temp("whole.h5"));
  const std::string bytes = ReadFile(Temp("whole.h5"));
  WriteFileAtomically(Temp("cut.h5"), bytes.substr(0, bytes.size() / 2));
  EXPECT_THAT([&] { ReadHeightMap(Temp("cut.h5")); }, Fails("cut off"));
  WriteHdf5(Temp("other.h5"), [](H5::H5File& f) { WriteSchema(f, "someone-else", 1); });
  EXPECT_THAT([&] { ReadHeightMap(Temp("other.h5")); },
              Fails("schema is \"someone-else\"; expected \"sandwright-heightmap\""));
  WriteHdf5(Temp("new.h5"), [](H5::H5File& f) { WriteSchema(f, "sandwright-heightmap", 2); });
  EXPECT_THAT([&] { ReadHeightMap(Temp("new.h5")); },
              Fails("schema_version of sandwright-heightmap is 2"));
  WriteHdf5(Temp("bare.h5"), [](H5::H5File&) {});
  EXPECT_THAT([&] { ReadHeightMap(Temp("bare.h5")); }, Fails("attribute schema is missing"));
}

TEST(HeightMapTest, BadFilesAreNamed) {
  const auto write = [](const char* name, std::vector<float> heights, size_t rows, size_t columns) {
    WriteHdf5(Temp(name), [&](H5::H5File& f) {
      WriteSchema(f, "sandwright-heightmap", 1);
      WriteNumber(f, "cell_size_m", 0.01);
      WriteText(f, "datum", "floor");
      WriteArray(f, "height_m", heights.data(), rows, columns);
    });
  };
  write("one.h5", {0.05f}, 1, 1);
  EXPECT_THAT([] { ReadHeightMap(Temp("one.h5")); }, Fails("one.h5: the map has 1 x 1"));
  write("infinite.h5", {0.05f, 0.05f, std::numeric_limits<float>::infinity(), 0.05f}, 2, 2);
  EXPECT_THAT([] { ReadHeightMap(Temp("infinite.h5")); }, Fails("row 1, column 0 is inf"));
  write("mask.h5", {0.05f, 0.05f, 0.05f, 0.05f}, 2, 2);
  {
    H5::H5File h5(Temp("mask.h5"), H5F_ACC_RDWR);
    const std::vector<uint8_t> mask(6, 1);
    WriteArray(h5, "mask", mask.data(), 2, 3);
  }
  EXPECT_THAT([] { ReadHeightMap(Temp("mask.h5")); }, Fails("dataset mask is 2 x 3"));
}

TEST(TaskTest, RoundTripAndGoalError) {
  Task task{Plane(4, 4, 0.01), Plane(4, 4, 0.01), 7};
  task.goal.mask.assign(16, 0);
  task.goal.mask[3] = task.goal.mask[9] = 1;
  task.goal.height_m[3] += 0.002f;
  task.goal.height_m[9] -= 0.004f;
  EXPECT_NEAR(GoalError(task.terrain, task.goal), 0.003, 1e-8);
  WriteTasks({task}, Temp("tasks.h5"));
  const auto back = ReadTasks(Temp("tasks.h5"));
  ASSERT_EQ(back.size(), 1u);
  EXPECT_EQ(back[0].goal.height_m, task.goal.height_m);
  EXPECT_EQ(back[0].goal.mask, task.goal.mask);
  EXPECT_EQ(back[0].max_strokes, 7);
}

TEST(TaskTest, DatumIsKeptAndMustBeOne) {
  Task task{Plane(4, 4, 0.01), Plane(4, 4, 0.01), 7};
  task.goal.mask.assign(16, 1);
  task.terrain.datum = Datum::kRelative;
  EXPECT_THAT([&] { CheckTask(task, "t"); }, Fails("one of terrain and goal has datum floor"));
  task.goal.datum = Datum::kRelative;
  WriteTasks({task}, Temp("relative.h5"));
  EXPECT_EQ(ReadTasks(Temp("relative.h5"))[0].terrain.datum, Datum::kRelative);
}

TEST(TaskTest, BadTasksAreNamed) {
  Task task{Plane(4, 4, 0.01), Plane(4, 4, 0.01), 7};
  task.goal.mask.assign(16, 0);
  EXPECT_THAT([&] { CheckTask(task, "t"); }, Fails("counts no cell"));
  task.goal.mask.assign(16, 1);
  task.max_strokes = 0;
  EXPECT_THAT([&] { CheckTask(task, "t"); }, Fails("max_strokes = 0"));
  task.max_strokes = 1;
  task.goal.height_m[6] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT([&] { CheckTask(task, "t"); },
              Fails("t: the goal is NaN at row 1, column 2, where its mask counts"));
  task.goal.mask[6] = 0;
  CheckTask(task, "t");
  task.goal.height_m[5] = -0.003f;
  EXPECT_THAT([&] { CheckTask(task, "t"); }, Fails("the goal reaches 3.0 mm below the floor"));
  task.goal.height_m.assign(16, 0.0f);
  EXPECT_THAT([&] { CheckTask(task, "t"); }, Fails("the goal holds no sand"));
  task.goal = Plane(4, 5, 0.01);
  EXPECT_THAT([&] { CheckTask(task, "t"); }, Fails("they must be equal"));
  task.goal = Plane(4, 4, 0.02);
  EXPECT_THAT([&] { CheckTask(task, "t"); },
              Fails("the terrain is 4 x 4 cells of 0.01 m, the goal 4 x 4 of 0.02 m"));
}

TEST(TaskTest, FilesNameTheirContentAndTheirSet) {
  Task task{Plane(4, 4, 0.01), Plane(4, 4, 0.01), 7};
  task.goal.mask.assign(16, 1);
  WriteTasks({task}, Temp("set.h5"), "easy-1");
  const H5::H5File file = OpenHdf5(Temp("set.h5"));
  EXPECT_EQ(ReadText(file, "benchmark", "f"), "easy-1");
  EXPECT_EQ(ReadText(file, "content_sha256", "f"), TasksSha256({task}));
  EXPECT_EQ(TasksSha256(ReadTasks(Temp("set.h5"))), TasksSha256({task}));
  std::set<std::string> hashes{TasksSha256({task}), TasksSha256({task, task})};
  for (int change = 0; change < 4; ++change) {
    Task other = task;
    if (change == 0) other.terrain.height_m[3] += 1e-6f;
    if (change == 1) other.goal.height_m[3] += 1e-6f;
    if (change == 2) other.goal.mask[3] = 0;
    if (change == 3) other.max_strokes = 8;
    hashes.insert(TasksSha256({other}));
  }
  EXPECT_EQ(hashes.size(), 6u);
}

TEST(TaskTest, ForeignAndDamagedFilesAreNamed) {
  EXPECT_THAT([] { ReadTasks("missing.h5"); }, Fails("missing.h5: no such file"));
  WriteHeightMap(Plane(4, 4, 0.01), Temp("map.h5"));
  EXPECT_THAT([] { ReadTasks(Temp("map.h5")); },
              Fails("schema is \"sandwright-heightmap\"; expected \"sandwright-tasks\""));
  WriteHdf5(Temp("new_tasks.h5"), [](H5::H5File& f) { WriteSchema(f, "sandwright-tasks", 2); });
  EXPECT_THAT([] { ReadTasks(Temp("new_tasks.h5")); },
              Fails("schema_version of sandwright-tasks is 2"));
  Task task{Plane(40, 40, 0.01), Plane(40, 40, 0.01), 7};
  task.goal.mask.assign(1600, 1);
  WriteTasks({task}, Temp("whole_tasks.h5"));
  const std::string bytes = ReadFile(Temp("whole_tasks.h5"));
  WriteFileAtomically(Temp("cut_tasks.h5"), bytes.substr(0, bytes.size() / 2));
  EXPECT_THAT([] { ReadTasks(Temp("cut_tasks.h5")); }, Fails("cut off"));
  H5::H5File h5(Temp("whole_tasks.h5"), H5F_ACC_RDWR);
  const std::vector<float> heights(1600, std::numeric_limits<float>::quiet_NaN());
  h5.openDataSet("/tasks/00000/terrain_m").write(heights.data(), H5::PredType::NATIVE_FLOAT);
  h5.close();
  EXPECT_THAT([] { ReadTasks(Temp("whole_tasks.h5")); },
              Fails("/tasks/00000/terrain_m: height_m at row 0"));
}

TEST(TaskTest, NanInAGoalFileMeansNotCounted) {
  HeightMap goal = Plane(3, 3, 0.01);
  goal.At(1, 1) = std::numeric_limits<float>::quiet_NaN();
  goal.mask.assign(9, 1);
  WriteHeightMap(goal, Temp("goal.h5"));
  EXPECT_EQ(ReadGoal(Temp("goal.h5")).mask[4], 0);
  EXPECT_THROW(ReadHeightMap(Temp("goal.h5")), Error);  // as a terrain it is bad
}

}  // namespace
}  // namespace sandwright
