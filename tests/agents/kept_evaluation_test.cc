// Strokes that are kept: stopped, continued, refused where they do not fit.
#include "agents/kept_evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "agents/random_agent.h"
#include "data/base/error.h"
#include "data/base/process.h"
#include "data/stroke_dataset.h"
#include "env/dem.h"
#include "env/heightfield.h"
#include "env/task_generator.h"

namespace sandwright {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::vector<Task> SmallTasks(int count) {
  std::vector<Task> tasks;
  for (int i = 0; i < count; ++i) {
    RandomStream stream(3, kEvaluationTasks, static_cast<uint64_t>(i));
    tasks.push_back(GenerateTask({.cell_size_m = 0.02, .max_strokes = 4}, stream));
  }
  return tasks;
}

// Chooses at random (or always one stroke), counts, and is interrupted when asked for a stroke too many.
class CountingAgent final : public Agent {
 public:
  explicit CountingAgent(int most = 1000, std::optional<Action> always = {}) : most_(most), always_(always) {}
  std::string name() const override { return "counting"; }
  std::vector<Action> Act(std::span<const TaskView> views, std::span<RandomStream> streams) override {
    if (asked == most_) throw Error("stopped by the user", ErrorKind::kInterrupted);
    ++asked;
    rejected.push_back(views.front().rejected_in_a_row);
    if (always_) return {*always_};
    return random_.Act(views, streams);
  }
  int64_t model_evaluations() const override { return 10 * asked; }
  int asked = 0;
  std::vector<int> rejected;

 private:
  int most_;
  std::optional<Action> always_;
  RandomAgent random_;
};

TEST(KeptEvaluation, GoesOnWhereItWasStoppedAndExecutesNothingTwice) {
  const std::vector<Task> tasks = SmallTasks(2);
  const Heightfield sand;
  const TemporaryFolder folder;
  const KeptIn stopped{folder.path() / "stopped"}, whole{folder.path() / "whole"};
  CountingAgent first(6), second, third, without;
  const Evaluation part = EvaluateKept(first, {sand}, {}, tasks, 7, stopped);
  EXPECT_TRUE(part.stopped);
  EXPECT_EQ(part.strokes, 6);
  const Evaluation rest = EvaluateKept(second, {sand}, {}, tasks, 7, stopped);
  EXPECT_FALSE(rest.stopped);
  EXPECT_EQ(second.asked, 2);
  EXPECT_EQ(rest.model_evaluations, 80);  // of all strokes, kept ones too
  const Evaluation again = EvaluateKept(third, {sand}, {}, tasks, 7, stopped);
  EXPECT_EQ(third.asked, 0);
  const Evaluation never = EvaluateKept(without, {sand}, {}, tasks, 7, whole);
  for (const Evaluation* other : {&rest, &again}) {
    EXPECT_EQ(other->per_task, never.per_task);
    for (size_t i = 0; i < tasks.size(); ++i) EXPECT_EQ(other->end[i].height_m, never.end[i].height_m);
  }
}

TEST(KeptEvaluation, KeepsStrokeFilesOfOneBedATask) {
  const std::vector<Task> tasks = SmallTasks(1);
  const Heightfield sand;
  const TemporaryFolder folder;
  CountingAgent agent, other;
  const Evaluation played = EvaluateKept(agent, {sand}, {}, tasks, 7, {folder.path() / "a"});
  EvaluateKept(other, {sand}, {}, tasks, 7, {folder.path() / "b"});
  const StrokeFile file = ReadStrokeFile(folder.path() / "a" / "task_00000.h5");
  EXPECT_EQ(file.source, "heightfield");
  EXPECT_EQ(file.bed, ReadStrokeFile(folder.path() / "b" / "task_00000.h5").bed);
  ASSERT_EQ(file.strokes.size(), 4u);
  EXPECT_EQ(file.strokes[0].before.height_m, tasks[0].terrain.height_m);
  for (size_t k = 1; k < 4; ++k) {
    EXPECT_EQ(file.strokes[k].before.height_m, file.strokes[k - 1].after.height_m);
    EXPECT_EQ(file.strokes[k].step, static_cast<int64_t>(k));
  }
  EXPECT_EQ(file.strokes[3].after.height_m, played.end[0].height_m);
  EXPECT_DOUBLE_EQ(played.per_task[0].at("in_goal_mean_diff_mm"),
                   1e3 * GoalError(file.strokes[3].after, tasks[0].goal));
}

TEST(KeptEvaluation, OtherSettingsAreRefusedByName) {
  const std::vector<Task> tasks = SmallTasks(2);
  const Heightfield sand;
  const TemporaryFolder folder;
  CountingAgent agent;
  const auto play = [&](std::span<const Task> of, uint64_t seed, const std::string& world) {
    EvaluateKept(agent, {sand}, {}, of, seed, {folder.path(), {{"world", world}}});
  };
  play(std::span(tasks).first(1), 7, "x");
  EXPECT_THAT([&] { play(std::span(tasks).first(1), 8, "x"); },
              ThrowsMessage<Error>(AllOf(HasSubstr("task_00000.h5"), HasSubstr("/seed is 7"))));
  EXPECT_THAT([&] { play(std::span(tasks).first(1), 7, "y"); }, ThrowsMessage<Error>(HasSubstr("/world is \"x\"")));
  EXPECT_THAT([&] { play(std::span(tasks).last(1), 7, "x"); }, ThrowsMessage<Error>(HasSubstr("/task_sha256")));
  play(tasks, 7, "x");  // further tasks may join
  std::filesystem::remove(folder.path() / ".task_00001_00004.bed");
  EXPECT_THAT([&] { play(tasks, 7, "x"); }, ThrowsMessage<Error>(HasSubstr(".task_00001_00004.bed")));
}

// Loses grains at the first stroke.
class LosingSand final : public SandModel {
 public:
  std::string name() const override { return "losing"; }
  const Blade& blade() const override { return sand_.blade(); }

 protected:
  std::vector<Outcome> ApplyChecked(std::span<SandState> states, std::span<const ToolPath> paths) const override {
    if (calls_++ == 0) throw GrainsLost("3 of 100 grains were lost in a stroke", ErrorKind::kInternal);
    return sand_.Apply(states, paths);
  }

 private:
  Heightfield sand_;
  mutable int calls_ = 0;
};

TEST(KeptEvaluation, AfterLostGrainsAnotherStrokeIsChosen) {
  const TemporaryFolder folder;
  const LosingSand sand;
  CountingAgent agent;
  const Evaluation played = EvaluateKept(agent, {sand}, {}, SmallTasks(1), 7, {folder.path()});
  EXPECT_EQ(played.strokes, 4);
  EXPECT_THAT(agent.rejected, ::testing::ElementsAre(0, 1, 0, 0, 0));
}

TEST(KeptEvaluation, GrainsGoOnFromTheBedThatIsKept) {
  if (!FindProgram("lmp")) GTEST_SKIP() << "LAMMPS is not installed";
  const TemporaryFolder folder;
  DemConfig config;
  config.reach_m = 0.05;
  config.cache = folder.path() / "beds";
  const Dem sand(config);
  const HeightMap terrain(25, 30, 0.004, 0.04f);
  Task task{terrain, terrain, 2};
  task.goal.mask.assign(task.goal.size(), 1);
  const Action shallow = {-0.3f, 0, 0, -1, -0.3f, -0.3f, 0};
  CountingAgent first(1, shallow), second(1000, shallow), without(1000, shallow);
  const auto play = [&](Agent& agent, const char* name) {
    return EvaluateKept(agent, {sand}, {.success_error_m = 0}, {&task, 1}, 7, {folder.path() / name});
  };
  EXPECT_TRUE(play(first, "stopped").stopped);
  const Evaluation rest = play(second, "stopped"), whole = play(without, "whole");
  EXPECT_EQ(second.asked, 1);
  EXPECT_EQ(rest.per_task, whole.per_task);
  EXPECT_EQ(rest.end[0].height_m, whole.end[0].height_m);
}

}  // namespace
}  // namespace sandwright
