#include "data/task.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "data/base/hdf5.h"
#include "data/base/sha256.h"

namespace sandwright {
namespace {

// NaN and mask 0 both mean "not counted"; afterwards the mask alone says so.
void FillMask(HeightMap& goal) {
  if (goal.mask.empty()) goal.mask.assign(goal.size(), 1);
  for (size_t i = 0; i < goal.size(); ++i) {
    if (std::isnan(goal.height_m[i])) goal.mask[i] = 0;
  }
}

HeightMap ReadTaskMap(const H5::Group& group, const std::string& name, double cell_size_m,
                      const std::string& where) {
  auto array = ReadArray<float>(group, name, where);
  HeightMap map;
  map.rows = static_cast<int>(array.rows);
  map.columns = static_cast<int>(array.columns);
  map.cell_size_m = cell_size_m;
  map.height_m = std::move(array.values);
  CheckHeightMap(map, where + "/" + name, name == "goal_m");
  return map;
}

// Files of other programs may leave it out: heights are then above the floor.
Datum ReadDatum(const H5::Group& group, const std::string& where) {
  if (!HasAttribute(group, "datum")) return Datum::kFloor;
  const std::string datum = ReadText(group, "datum", where);
  if (datum != "floor" && datum != "relative")
    throw Error(where + ": datum is \"" + datum + "\"; allowed: floor, relative");
  return datum == "floor" ? Datum::kFloor : Datum::kRelative;
}

void CheckCounted(const HeightMap& goal, const std::string& source) {
  bool any = false;
  double lowest_m = 0, sum_m = 0;
  for (size_t i = 0; i < goal.size(); ++i) {
    if (!goal.mask[i]) continue;
    any = true;
    const double height_m = goal.height_m[i];
    if (std::isnan(height_m))
      throw Error(fmt::format("{}: the goal is NaN at row {}, column {}, where its mask counts",
                              source, i / static_cast<size_t>(goal.columns),
                              i % static_cast<size_t>(goal.columns)));
    lowest_m = std::min(lowest_m, height_m);
    sum_m += height_m;
  }
  if (!any) throw Error(source + ": the goal counts no cell (mask all 0 or heights all NaN)");
  if (goal.datum != Datum::kFloor) return;
  if (lowest_m < 0)
    throw Error(fmt::format("{}: the goal reaches {:.1f} mm below the floor; at least 0 is allowed",
                            source, -1e3 * lowest_m));
  if (sum_m == 0)
    throw Error(source + ": the goal holds no sand: every cell that counts lies on the floor");
}

// The bytes of a vector, for a hash.
template <class T>
std::string_view Bytes(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

}  // namespace

void CheckTask(const Task& task, const std::string& source) {
  if (!task.terrain.SameGrid(task.goal))
    throw Error(
        fmt::format("{}: the terrain is {} x {} cells of {} m, the goal {} x {} of {} m; they "
                    "must be equal",
                    source, task.terrain.rows, task.terrain.columns, task.terrain.cell_size_m,
                    task.goal.rows, task.goal.columns, task.goal.cell_size_m));
  if (task.terrain.datum != task.goal.datum)
    throw Error(source +
                ": one of terrain and goal has datum floor, the other relative; their heights "
                "cannot be compared");
  if (task.goal.mask.size() != task.goal.size())
    throw Error(source + ": the mask has another size than the goal");
  CheckCounted(task.goal, source);
  if (task.max_strokes < 1)
    throw Error(fmt::format("{}: max_strokes = {}; must be >= 1", source, task.max_strokes));
}

HeightMap ReadGoal(const std::filesystem::path& file) {
  HeightMap goal = ReadHeightMap(file, true);
  FillMask(goal);
  return goal;
}

std::vector<Task> ReadTasks(const std::filesystem::path& file) {
  const H5::H5File h5 = OpenHdf5(file);
  CheckSchema(h5, file.string(), "sandwright-tasks", 1);
  const double cell_size_m = ReadNumber(h5, "cell_size_m", file.string());
  std::vector<Task> tasks;
  try {
    const H5::Group groups = h5.openGroup("tasks");
    for (const std::string& name : GroupNames(groups)) {
      const H5::Group group = groups.openGroup(name);
      const std::string where = file.string() + ":/tasks/" + name;
      Task task;
      task.terrain = ReadTaskMap(group, "terrain_m", cell_size_m, where);
      task.goal = ReadTaskMap(group, "goal_m", cell_size_m, where);
      task.goal.mask = ReadArray<uint8_t>(group, "mask", where).values;
      task.max_strokes = static_cast<int>(ReadInteger(group, "max_strokes", where));
      task.terrain.datum = task.goal.datum = ReadDatum(group, where);
      CheckTask(task, where);
      tasks.push_back(std::move(task));
    }
  } catch (const H5::Exception&) {
    throw Error(file.string() + ": group /tasks is missing or cut off");
  }
  if (tasks.empty()) throw Error(file.string() + ": holds no task");
  return tasks;
}

void WriteTasks(const std::vector<Task>& tasks, const std::filesystem::path& file,
                const std::string& benchmark) {
  SAND_CHECK(!tasks.empty());
  WriteHdf5(file, [&](H5::H5File& h5) {
    WriteSchema(h5, "sandwright-tasks", 1);
    WriteNumber(h5, "cell_size_m", tasks.front().terrain.cell_size_m);
    if (!benchmark.empty()) WriteText(h5, "benchmark", benchmark);
    WriteText(h5, "content_sha256", TasksSha256(tasks));
    H5::Group groups = h5.createGroup("tasks");
    for (size_t i = 0; i < tasks.size(); ++i) {
      const Task& task = tasks[i];
      CheckTask(task, fmt::format("task {}", i));
      SAND_CHECK(task.terrain.cell_size_m == tasks.front().terrain.cell_size_m, i);
      H5::Group group = groups.createGroup(fmt::format("{:05}", i));
      const auto rows = static_cast<size_t>(task.terrain.rows);
      const auto columns = static_cast<size_t>(task.terrain.columns);
      WriteArray(group, "terrain_m", task.terrain.height_m.data(), rows, columns);
      WriteArray(group, "goal_m", task.goal.height_m.data(), rows, columns);
      WriteArray(group, "mask", task.goal.mask.data(), rows, columns);
      WriteInteger(group, "max_strokes", task.max_strokes);
      WriteText(group, "datum", task.terrain.datum == Datum::kFloor ? "floor" : "relative");
    }
  });
}

std::string TasksSha256(const std::vector<Task>& tasks) {
  std::string content;
  for (const Task& task : tasks) {
    content += fmt::format("{} {} {} {} {}\n", task.terrain.rows, task.terrain.columns,
                           task.terrain.cell_size_m, static_cast<int>(task.terrain.datum),
                           task.max_strokes);
    content += Bytes(task.terrain.height_m);
    content += Bytes(task.goal.height_m);
    content += Bytes(task.goal.mask);
  }
  return Sha256Hex(content);
}

double GoalError(const HeightMap& heights, const HeightMap& goal) {
  SAND_CHECK(heights.size() == goal.size() && goal.mask.size() == goal.size(), heights.size(),
             goal.size());
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < goal.size(); ++i) {
    if (!goal.mask[i]) continue;
    sum += std::abs(static_cast<double>(heights.height_m[i]) - goal.height_m[i]);
    ++count;
  }
  SAND_CHECK(count > 0);
  return sum / static_cast<double>(count);
}

}  // namespace sandwright
