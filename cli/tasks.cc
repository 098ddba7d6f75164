// sandwright tasks: task files, from scanned or generated terrains and given or generated goals.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <numeric>

#include "cli/command.h"
#include "data/base/parallel.h"
#include "env/task_generator.h"

namespace sandwright {
namespace {

class TasksCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    auto* terrain = app.add_option("--terrain", terrain_files_, "height map files, one or more");
    auto* generate = app.add_flag("--generate", generate_, "random terrains");
    auto* goal = app.add_option("--goal", goal_file_, "goal for every terrain: a height map file");
    auto* goals = app.add_option("--goals", kinds_, "kinds of random goals, separated by commas")
                      ->delimiter(',');
    app.add_option("--count", count_, "tasks (default: one a terrain; 10 with --generate)")
        ->check(CLI::Range(1, 1000000));
    app.add_option("--out", out_, "task file to write")->required();
    generate->excludes(terrain)->excludes(goal);
    goal->excludes(goals);
  }
  void Fields(FieldList& f) override { f.Section("tasks", config_); }

  int Run() override {
    if (!kinds_.empty()) config_.goals = kinds_;
    const std::vector<Task> tasks = generate_ ? Generated() : OnTerrains();
    std::vector<double> error_mm;
    for (const Task& task : tasks) error_mm.push_back(1e3 * GoalError(task.terrain, task.goal));
    const double mean_mm =
        std::accumulate(error_mm.begin(), error_mm.end(), 0.0) / static_cast<double>(tasks.size());
    WriteTasks(tasks, out_);
    fmt::print("{} tasks, goal error {:.1f} mm ({:.1f} to {:.1f}): {}\n", tasks.size(), mean_mm,
               std::ranges::min(error_mm), std::ranges::max(error_mm), out_);
    WriteResult({{"tasks", tasks.size()},
                 {"out", out_},
                 {"in_goal_mean_diff_start_mm", mean_mm},
                 {"per_task_in_goal_mean_diff_start_mm", error_mm}});
    return 0;
  }

 private:
  std::vector<Task> Generated() const {
    std::vector<Task> tasks(static_cast<size_t>(count_ > 0 ? count_ : 10));
    ParallelFor(static_cast<int>(tasks.size()), threads(), [&](int i) {
      RandomStream stream(seed(), kEvaluationTasks, static_cast<uint64_t>(i));
      tasks[static_cast<size_t>(i)] = GenerateTask(config_, stream);
    });
    return tasks;
  }

  std::vector<Task> OnTerrains() const {
    if (terrain_files_.empty()) throw Error("tasks needs --terrain FILE... or --generate");
    if (goal_file_.empty() && kinds_.empty())
      throw Error("--terrain needs --goal FILE or --goals KIND,...");
    const size_t count = count_ > 0 ? static_cast<size_t>(count_) : terrain_files_.size();
    if (!goal_file_.empty() && count > terrain_files_.size())
      throw Error(
          fmt::format("--count {} with one --goal would repeat tasks; at most {}, the terrains",
                      count, terrain_files_.size()));
    std::vector<HeightMap> terrains;
    for (const std::string& file : terrain_files_) {
      terrains.push_back(ReadHeightMap(file));
      if (terrains.back().cell_size_m != terrains[0].cell_size_m)
        throw Error(fmt::format("{}: cell_size_m = {}; {} has {}, and a task file holds one size",
                                file, terrains.back().cell_size_m, terrain_files_[0],
                                terrains[0].cell_size_m));
    }
    std::vector<Task> tasks;
    for (size_t i = 0; i < count; ++i) {
      const HeightMap& terrain = terrains[i % terrains.size()];
      RandomStream stream(seed(), kEvaluationTasks, i);
      tasks.push_back(goal_file_.empty() ? GenerateGoal(config_, terrain, stream)
                                         : Task{terrain, ReadGoal(goal_file_),
                                                static_cast<int>(config_.max_strokes)});
      CheckTask(tasks.back(), terrain_files_[i % terrains.size()] + " and its goal");
    }
    return tasks;
  }

  TaskConfig config_;
  std::vector<std::string> terrain_files_, kinds_;
  std::string goal_file_, out_;
  bool generate_ = false;
  int count_ = 0;
};

}  // namespace

std::unique_ptr<Command> MakeTasksCommand() { return std::make_unique<TasksCommand>(); }

}  // namespace sandwright
