// sandwright tasks: task files, from scanned or generated terrains and given or generated goals, or a
// fixed set.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <numeric>

#include "cli/command.h"
#include "cli/task_request.h"
#include "data/drawing.h"
#include "data/picture.h"
#include "data/scan_folder.h"
#include "env/benchmark_tasks.h"
#include "env/task_sheet.h"

namespace sandwright {
namespace {

constexpr size_t kPictured = 24;

class TasksCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    auto* terrain = app.add_option("--terrain", request_.terrain_files, "height map files, one or more");
    auto* generate = app.add_flag("--generate", request_.generate, "random terrains");
    auto* set = app.add_option("--set", set_, "a fixed set: easy, hard, scanned or real");
    auto* scans = app.add_option("--scans", scans_, "folder of the scans that set real is cut from");
    auto* goal = app.add_option("--goal", request_.goal_file, "goal for every terrain: a height map file");
    app.add_flag("--vary", request_.vary, "variations of --goal, --count of them (keys vary)")->needs(goal);
    auto* goals = app.add_option("--goals", kinds_, "kinds of random goals, separated by commas")
                      ->delimiter(',');
    auto* image = app.add_option("--goal-image", image_, "goal for every terrain: a grey picture");
    auto* range = app.add_option("--range-mm", range_mm_, "its white above its black; negative: below")
                      ->check(CLI::Range(-500.0, 500.0));
    auto* count = app.add_option("--count", request_.count, "tasks (default: one a terrain; 10 with --generate)")
                      ->check(CLI::Range(1, 1000000));
    app.add_option("--out", out_, "task file to write")->required();
    app.add_option("--picture", picture_, "PNG of the first 24 tasks to write: terrain and goal");
    generate->excludes(terrain)->excludes(goal);
    goal->excludes(goals)->excludes(image);
    image->excludes(goals)->needs(range);
    range->needs(image);
    scans->needs(set);
    for (auto* other : {terrain, generate, goal, goals, image, count}) set->excludes(other);
  }
  void Fields(FieldList& f) override {
    f.Section("tasks", config_);
    f.Section("scans", scan_config_);
    f.Section("vary", request_.variation);
  }

  int Run() override {
    if (!kinds_.empty()) config_.goals = kinds_;
    if (!image_.empty() && range_mm_ == 0) throw Error("--range-mm 0 makes nothing of a drawing");
    if (!image_.empty()) request_.drawing = ReadDrawing(image_);
    request_.range_m = 1e-3 * range_mm_;
    request_.random_goals = !kinds_.empty();
    const Benchmark made = set_.empty() ? Benchmark{"", MakeTasks(request_, config_, seed(), threads())} : FixedSet();
    std::vector<double> error_mm;
    for (const Task& task : made.tasks) error_mm.push_back(1e3 * GoalError(task.terrain, task.goal));
    const double mean_mm = std::accumulate(error_mm.begin(), error_mm.end(), 0.0) /
                           static_cast<double>(error_mm.size());
    const std::string content = TasksSha256(made.tasks);
    if (!picture_.empty())
      WritePicture(DrawTasks(std::span(made.tasks).first(std::min(kPictured, made.tasks.size()))), picture_);
    WriteTasks(made.tasks, out_, made.id);
    fmt::print("{}{} tasks, goal error {:.1f} mm ({:.1f} to {:.1f}): {}\ncontent sha256 {}\n",
               made.id.empty() ? "" : made.id + ": ", made.tasks.size(), mean_mm,
               std::ranges::min(error_mm), std::ranges::max(error_mm), out_, content);
    WriteResult({{"tasks", made.tasks.size()},
                 {"out", out_},
                 {"benchmark", made.id},
                 {"content_sha256", content},
                 {"in_goal_mean_diff_start_mm", mean_mm},
                 {"per_task_in_goal_mean_diff_start_mm", error_mm}});
    return 0;
  }

 private:
  Benchmark FixedSet() const {
    BenchmarkConfig(set_);  // an unknown name is an error whatever else is given
    TaskConfig untouched;
    if (seed() != 0 || ToJson(FieldsOf(untouched)) != ResolvedConfig()["tasks"])
      throw Error("--set " + set_ + " is fixed: --seed and the keys tasks have no effect on it");
    if ((set_ == "real") == scans_.empty())
      throw Error("--scans DIR belongs to --set real, and only there");
    if (set_ != "real") return MakeBenchmark(set_, threads());
    const ScanFolder folder = ReadScanFolder(scans_, scan_config_);
    spdlog::info("{} scans: {}", folder.files.size(), fmt::join(folder.files, ", "));
    for (const std::string& refusal : folder.refusals) spdlog::warn("left out: {}", refusal);
    return MakeRealBenchmark(folder.maps);
  }

  TaskConfig config_;
  ScanFolderConfig scan_config_;
  TaskRequest request_;
  std::vector<std::string> kinds_;
  std::string image_, set_, scans_, out_, picture_;
  double range_mm_ = 0;
};

}  // namespace

std::unique_ptr<Command> MakeTasksCommand() { return std::make_unique<TasksCommand>(); }

}  // namespace sandwright
