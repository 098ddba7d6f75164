// All planners by their names: what they have in common.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "agents/evaluate.h"
#include "agents/load_agent.h"
#include "data/base/error.h"
#include "env/heightfield.h"
#include "env/load_gate.h"
#include "robot_model/safety_gate.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// 300 x 300 mm of level sand with a mound, or a hollow, to be levelled.
Task MoundTask(double x_m, double y_m, int max_strokes, double rise_m = 0.03) {
  Task task{HeightMap(30, 30, 0.01, 0.05f), {}, max_strokes};
  double sum = 0;
  for (int row = 0; row < 30; ++row) {
    for (int column = 0; column < 30; ++column) {
      const double away_m = std::hypot((column + 0.5) * 0.01 - x_m, (row + 0.5) * 0.01 - y_m);
      task.terrain.At(row, column) += static_cast<float>(rise_m * std::exp(-std::pow(away_m / 0.07, 2)));
      sum += task.terrain.At(row, column);
    }
  }
  task.goal = HeightMap(30, 30, 0.01, static_cast<float>(sum / 900));
  task.goal.mask.assign(900, 1);
  return task;
}

std::vector<Task> Mounds(int max_strokes) {
  return {MoundTask(0.12, 0.15, max_strokes), MoundTask(0.18, 0.2, max_strokes),
          MoundTask(0.15, 0.1, max_strokes)};
}

TaskView ViewOf(const Task& task, int rejected_in_a_row = 0) {
  return {.sensed = task.terrain,
          .goal = task.goal,
          .region = {0, 0, 0.3, 0.3},
          .max_strokes = task.max_strokes,
          .rejected_in_a_row = rejected_in_a_row};
}

PlannerConfigs Small() {
  PlannerConfigs planners;
  planners.greedy.evaluations = planners.cem.evaluations = planners.ga.evaluations =
      planners.ranked.evaluations = 40;
  return planners;
}

class Planner : public ::testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<Agent> Load(const SafetyGate* gate = nullptr,
                              const PlannerConfigs& planners = Small()) const {
    return LoadAgent(GetParam(), {sand_, planners, 0.1, "cpu", gate});
  }
  // One view at a time, view i with stream i.
  static std::vector<Action> OneByOne(Agent& agent, std::span<const Task> tasks) {
    std::vector<Action> actions;
    for (size_t i = 0; i < tasks.size(); ++i) {
      const TaskView view = ViewOf(tasks[i]);
      RandomStream stream(5, 0, i);
      actions.push_back(agent.Act({&view, 1}, {&stream, 1}).front());
    }
    return actions;
  }
  bool MakesModelCalls() const { return Load()->name() != "sweep" && Load()->name() != "boustrophedon"; }

  Heightfield sand_;
};

TEST_P(Planner, LevelsAMoundFarBetterThanChance) {
  const std::vector<Task> tasks = Mounds(8);
  const World world{sand_, nullptr, 1};
  const auto agent = Load();
  EXPECT_EQ(agent->name(), GetParam());
  const auto random = LoadAgent("random", {sand_});
  const double start_mm = Evaluate(*random, world, {}, tasks, 7).Mean("in_goal_mean_diff_start_mm");
  const double chance_mm = Evaluate(*random, world, {}, tasks, 7).Mean("in_goal_mean_diff_mm");
  const Evaluation result = Evaluate(*agent, world, {}, tasks, 7);
  EXPECT_LT(result.Mean("in_goal_mean_diff_mm"), 0.8 * start_mm);
  EXPECT_LT(result.Mean("in_goal_mean_diff_mm"), 0.65 * chance_mm);
  const double evaluations = result.ToJson()["model_evaluations_per_stroke"];
  EXPECT_EQ(evaluations, MakesModelCalls() ? 40 : 0);
}

TEST_P(Planner, TheSameSeedGivesTheSameBytesInAnyCompany) {
  const std::vector<Task> tasks = Mounds(6);
  const auto agent = Load();
  const std::vector<Action> alone = OneByOne(*agent, tasks);
  EXPECT_EQ(alone, OneByOne(*Load(), tasks));
  std::vector<TaskView> views;
  std::vector<RandomStream> streams;
  for (size_t i : {2, 0, 1}) {
    views.push_back(ViewOf(tasks[i]));
    streams.emplace_back(5, 0, i);
  }
  const std::vector<Action> together = agent->Act(views, streams);
  EXPECT_EQ(together, (std::vector<Action>{alone[2], alone[0], alone[1]}));
  HeightfieldConfig two_threads;
  two_threads.threads = 2;
  const Heightfield threaded(two_threads);
  const auto other = LoadAgent(GetParam(), {threaded, Small(), 0.1, "cpu"});
  EXPECT_EQ(OneByOne(*other, tasks), alone);
  EXPECT_TRUE(agent->Act({}, {}).empty());
}

TEST_P(Planner, ChoosesWhatTheGateAccepts) {
  const auto gate = LoadGate("workcell_small.yaml");
  // Mounds and hollows at the wall, where most strokes that pay would leave the box.
  const std::vector<Task> tasks = {MoundTask(0.03, 0.15, 6), MoundTask(0.15, 0.02, 6, -0.03),
                                   MoundTask(0.28, 0.28, 6, -0.03)};
  const auto refused = [&](const std::vector<Action>& actions) {
    int count = 0;
    for (size_t i = 0; i < tasks.size(); ++i) {
      const Stroke stroke =
          DecodeAction(actions[i], tasks[i].terrain, ViewOf(tasks[i]).region, sand_.blade(), 0.1);
      count += !gate->Check(stroke, tasks[i].terrain, GateSampling::kCoarse).accepted;
    }
    return count;
  };
  EXPECT_GT(refused(OneByOne(*Load(), tasks)), 0);  // so the gate makes a difference
  EXPECT_EQ(refused(OneByOne(*Load(gate.get()), tasks)), 0);
}

TEST_P(Planner, ARefusedStrokeIsNotRepeated) {
  const Task task = MoundTask(0.12, 0.15, 6);
  const auto agent = Load();
  RandomStream stream(5);
  std::vector<Action> actions;
  for (int rejected = 0; rejected < 3; ++rejected) {
    const TaskView view = ViewOf(task, rejected);
    actions.push_back(agent->Act({&view, 1}, {&stream, 1}).front());
  }
  EXPECT_NE(actions[0], actions[1]);
  EXPECT_NE(actions[1], actions[2]);
  EXPECT_NE(actions[0], actions[2]);
}

INSTANTIATE_TEST_SUITE_P(All, Planner,
                         ::testing::Values("boustrophedon", "sweep", "greedy", "cem", "ga",
                                           "ranked"),
                         [](const auto& named) { return std::string(named.param); });

TEST(FirstAccepted, AnExhaustedListEndsInChance) {
  const Task task = MoundTask(0.12, 0.15, 6);
  const Action only = {0, 0, 0, 0, 0, 0, 0};
  RandomStream stream(1), untouched(1);
  EXPECT_EQ(FirstAccepted({}, ViewOf(task, 0), {&only, 1}, stream), only);
  EXPECT_EQ(stream.Next32(), untouched.Next32());
  const Action first = FirstAccepted({}, ViewOf(task, 1), {&only, 1}, stream);
  EXPECT_NE(first, only);
  EXPECT_NE(FirstAccepted({}, ViewOf(task, 2), {&only, 1}, stream), first);
}

TEST(PlannerConfigs, WhatDoesNotGoTogetherIsNamed) {
  const StillSand sand;
  PlannerConfigs planners;
  planners.cem.evaluations = planners.ga.evaluations = 11;
  planners.cem.horizon = planners.ga.horizon = 3;
  planners.cem.iterations = planners.ga.generations = 4;
  EXPECT_THAT([&] { LoadAgent("cem", {sand, planners}); },
              ThrowsMessage<Error>(HasSubstr(
                  "cem.evaluations = 11: 4 rounds of plans of 3 strokes need at least 12")));
  EXPECT_THAT([&] { LoadAgent("ga", {sand, planners}); },
              ThrowsMessage<Error>(HasSubstr("ga.evaluations = 11")));
  planners.ranked.policy = "nobody";
  EXPECT_THAT([&] { LoadAgent("ranked", {sand, planners}); },
              ThrowsMessage<Error>(HasSubstr("no policy 'nobody'; allowed: default, sampler, walled or a .saf")));
  const std::string unknown = "cem.evaluation=3", range = "sweep.bin_m=-1";
  EXPECT_THAT([&] { ApplyOverrides(FieldsOf(planners), {&unknown, 1}); },
              ThrowsMessage<Error>(HasSubstr("cem.evaluations")));
  EXPECT_THAT([&] { ApplyOverrides(FieldsOf(planners), {&range, 1}); },
              ThrowsMessage<Error>(HasSubstr("sweep.bin_m")));
}

}  // namespace
}  // namespace sandwright
