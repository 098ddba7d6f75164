// Rivals and evaluation on a small bed.
#include "agents/evaluate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include "agents/greedy.h"
#include "agents/load_agent.h"
#include "agents/random_agent.h"
#include "data/base/error.h"
#include "data/base/stop.h"
#include "env/heightfield.h"
#include "env/task_generator.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;

std::vector<Task> SmallTasks(int count) {
  TaskConfig config;
  config.cell_size_m = 0.02;
  config.max_strokes = 4;
  std::vector<Task> tasks;
  for (int i = 0; i < count; ++i) {
    RandomStream stream(3, kEvaluationTasks, static_cast<uint64_t>(i));
    tasks.push_back(GenerateTask(config, stream));
  }
  return tasks;
}

TEST(Evaluate, TheSameSeedGivesTheSameScoresForAnyThreadsAndOrder) {
  const std::vector<Task> tasks = SmallTasks(4);
  const Heightfield sand;
  RandomAgent agent;
  const Evaluation one = Evaluate(agent, {sand, nullptr, 1}, {}, tasks, 7);
  const Evaluation two = Evaluate(agent, {sand, nullptr, 2}, {}, tasks, 7);
  EXPECT_EQ(one.per_task, two.per_task);
  // A task's result does not depend on the tasks beside it.
  const Evaluation first = Evaluate(agent, {sand, nullptr, 1}, {}, std::span(tasks).first(1), 7);
  EXPECT_EQ(first.per_task[0], one.per_task[0]);
  const Evaluation other = Evaluate(agent, {sand, nullptr, 1}, {}, tasks, 8);
  EXPECT_NE(one.per_task, other.per_task);
}

TEST(Evaluate, StillSandKeepsTheStartError) {
  const std::vector<Task> tasks = SmallTasks(2);
  const StillSand sand;
  RandomAgent agent;
  const auto json = Evaluate(agent, {sand, nullptr, 1}, {}, tasks, 7).ToJson();
  EXPECT_DOUBLE_EQ(json["in_goal_mean_diff_mm"], json["in_goal_mean_diff_start_mm"]);
  EXPECT_EQ(json["strokes"], 4.0);
  EXPECT_EQ(json["moved_volume_cm3"], 0.0);
  EXPECT_EQ(json["in_goal_cells_changed"], 0.0);
  EXPECT_EQ(json["model_evaluations_per_stroke"], 0.0);
  EXPECT_EQ(json["world"], "none");
  EXPECT_EQ(json["per_task"].size(), 2u);
  for (const char* key : {"5", "10", "20"})
    EXPECT_DOUBLE_EQ(json["error_after_mm"][key], json["in_goal_mean_diff_mm"]);
  for (const char* key : {"agent", "rmse_mm", "rejected_strokes", "success_rate",
                          "ms_per_stroke_agent", "ms_per_stroke_world"})
    EXPECT_TRUE(json.contains(key)) << key;
}

TEST(EvaluateDeathTest, AStopKeepsTheStrokesSoFar) {
  EXPECT_EXIT(
      {
        InstallStopHandler();
        const std::vector<Task> tasks = SmallTasks(2);
        const StillSand sand;
        RandomAgent agent;
        const auto stop = [](int64_t) { std::raise(SIGINT); };
        const auto json = Evaluate(agent, {sand, nullptr, 1}, {}, tasks, 7, stop).ToJson();
        std::_Exit(json["stopped"] == true && json["strokes"] == 1.0 ? 7 : 8);
      },
      ::testing::ExitedWithCode(7), "");
}

TEST(Evaluate, NoTasksIsAnError) {
  const StillSand sand;
  RandomAgent agent;
  EXPECT_THROW(Evaluate(agent, {sand, nullptr, 1}, {}, {}, 7), Error);
}

TEST(Evaluate, DrawsOnePictureATask) {
  const std::vector<Task> tasks = SmallTasks(2);
  const StillSand sand;
  RandomAgent agent;
  const auto folder = std::filesystem::path(::testing::TempDir()) / "eval_pictures";
  DrawEvaluation(Evaluate(agent, {sand, nullptr, 1}, {}, tasks, 7), tasks, folder);
  EXPECT_GT(std::filesystem::file_size(folder / "task_00000.png"), 100u);
  EXPECT_GT(std::filesystem::file_size(folder / "task_00001.png"), 100u);
}

TEST(GreedyAgent, ChoosesWhatItsModelSaysIsBest) {
  const std::vector<Task> tasks = SmallTasks(3);
  const Heightfield sand;
  GreedyAgent greedy(StrokeJudge(sand, 0.1), {.evaluations = 40});
  const Evaluation result = Evaluate(greedy, {sand, nullptr, 2}, {}, tasks, 7);
  RandomAgent random;
  const Evaluation rival = Evaluate(random, {sand, nullptr, 2}, {}, tasks, 7);
  for (size_t i = 0; i < tasks.size(); ++i) {
    EXPECT_LT(result.per_task[i].at("in_goal_mean_diff_mm"),
              result.per_task[i].at("in_goal_mean_diff_start_mm"));
    EXPECT_LT(result.per_task[i].at("in_goal_mean_diff_mm"),
              rival.per_task[i].at("in_goal_mean_diff_mm"));
  }
  EXPECT_DOUBLE_EQ(result.ToJson()["model_evaluations_per_stroke"], 40.0);
}

TEST(GreedyAgent, SeesTheSensedMapOnlyAndIsDeterministic) {
  const std::vector<Task> tasks = SmallTasks(1);
  const Heightfield sand;
  GreedyAgent greedy(StrokeJudge(sand, 0.1), {.evaluations = 10});
  const TaskView view{tasks[0].terrain, tasks[0].goal, RegionOf(tasks[0], {}), 0, 4, 0};
  RandomStream first(1), second(1);
  const auto a = greedy.Act({&view, 1}, {&first, 1}), b = greedy.Act({&view, 1}, {&second, 1});
  EXPECT_EQ(a, b);
  for (float number : a[0]) EXPECT_LE(std::abs(number), 1.0f);
  EXPECT_TRUE(greedy.Act({}, {}).empty());
}

TEST(LoadAgent, NamesWhatThereIs) {
  const StillSand sand;
  const AgentOptions options{sand};
  EXPECT_EQ(LoadAgent("random", options)->name(), "random");
  EXPECT_EQ(LoadAgent("greedy", options)->name(), "greedy");
  for (const char* name : {"mcts", "nonsense"}) {
    try {
      LoadAgent(name, options);
      ADD_FAILURE() << name;
    } catch (const Error& e) {
      EXPECT_THAT(e.what(), HasSubstr(std::string("no agent '") + name +
                                      "' in this version; allowed: random, boustrophedon, sweep, greedy, cem, ga, ranked"));
    }
  }
  EXPECT_THROW(LoadAgent("missing.safetensors", options), Error);
}

}  // namespace
}  // namespace sandwright
