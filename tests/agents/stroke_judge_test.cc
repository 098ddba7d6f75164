// The judge of plans, and the budget and the distributions of those who search with it.
#include "agents/stroke_judge.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "agents/plan_distribution.h"
#include "agents/planning_budget.h"
#include "agents/stroke_proposal.h"
#include "data/task.h"
#include "env/heightfield.h"
#include "env/load_gate.h"
#include "robot_model/safety_gate.h"

namespace sandwright {
namespace {

constexpr double kSpeed_mps = 0.1;

// A heap on one side of 300 x 300 mm.
struct Heap {
  HeightMap sensed = HeightMap(15, 15, 0.02, 0.05f), goal = HeightMap(15, 15, 0.02, 0.055f);
  TaskView view{.sensed = sensed, .goal = goal, .region = {0, 0, 0.3, 0.3}, .max_strokes = 5};
  Heap() {
    for (int row = 5; row < 10; ++row)
      for (int column = 3; column < 7; ++column) sensed.At(row, column) = 0.08f;
    goal.mask.assign(goal.size(), 1);
  }
};

std::vector<StrokePlan> RandomPlans(size_t count, size_t strokes) {
  RandomStream stream(1);
  std::vector<StrokePlan> plans(count);
  for (StrokePlan& plan : plans)
    for (size_t s = 0; s < strokes; ++s) plan.push_back(RandomAction(stream));
  return plans;
}

TEST(StrokeJudge, ErrorIsThatOfTheSandAfterTheLastStroke) {
  const Heap heap;
  const Heightfield sand;
  StrokeJudge judge(sand, kSpeed_mps);
  const auto plans = RandomPlans(3, 2);
  const auto judged = judge.Judge(heap.view, plans);
  ASSERT_EQ(judged.size(), 3u);
  EXPECT_EQ(judge.model_evaluations(), 6);
  for (size_t i = 0; i < plans.size(); ++i) {
    SandState state(heap.sensed);
    for (const Action& action : plans[i]) {
      const Stroke stroke =
          DecodeAction(action, state.map(), heap.view.region, sand.blade(), kSpeed_mps);
      sand.Apply({&state, 1}, {&stroke, 1});
    }
    EXPECT_EQ(judged[i].strokes, plans[i]);
    EXPECT_EQ(judged[i].error_m, GoalError(state.map(), heap.goal));
    EXPECT_FALSE(judged[i].accepted.has_value());
  }
}

TEST(StrokeJudge, ManyPlansAreJudgedInPartsAsIfAlone) {
  const Heap heap;
  const Heightfield sand;
  StrokeJudge judge(sand, kSpeed_mps);
  const auto plans = RandomPlans(2500, 1);  // more than a batch
  const auto judged = judge.Judge(heap.view, plans);
  ASSERT_EQ(judged.size(), plans.size());
  EXPECT_EQ(judge.model_evaluations(), 2500);
  for (size_t i : {0, 1023, 1024, 2048, 2499}) {
    EXPECT_EQ(judged[i].strokes, plans[i]);
    EXPECT_EQ(judged[i].error_m, judge.Judge(heap.view, {plans[i]})[0].error_m) << i;
  }
}

TEST(StrokeJudge, KeepsAcceptedPlansFirstAndAsksNoMoreThanItMust) {
  const Heap heap;
  const StillSand sand;
  const auto gate = LoadGate("workcell_small.yaml");
  const StrokeJudge judge(sand, kSpeed_mps, gate.get());
  const Action inside = {-0.2f, 0, 0, -0.5f, 0, -1, 0}, away = {1, 1, 0, 1, 0, 0, 0};
  const std::vector<JudgedPlan> plans = {
      {{inside}, 0.004, {}}, {{away}, 0.001, {}}, {{inside}, 0.002, {}}, {{inside}, 0.003, {}}};
  std::vector<JudgedPlan> best = plans;
  judge.KeepBest(heap.view, 1, best);
  ASSERT_EQ(best.size(), 1u);
  EXPECT_EQ(best[0].error_m, 0.002);
  std::vector<JudgedPlan> two = plans;
  judge.KeepBest(heap.view, 2, two);
  EXPECT_EQ(two[1].error_m, 0.003);
  std::vector<JudgedPlan> all = plans;
  judge.KeepBest(heap.view, 9, all);
  ASSERT_EQ(all.size(), 4u);
  EXPECT_EQ(all[3].error_m, 0.001);  // refused, so last
  EXPECT_EQ(all[3].accepted, false);
  // What was known is not asked again: a stroke that passed stays accepted.
  std::vector<JudgedPlan> known = {{{away}, 0.001, true}, {{inside}, 0.002, {}}};
  judge.KeepBest(heap.view, 1, known);
  EXPECT_EQ(known[0].error_m, 0.001);
  // Where the gate accepts none, the best is kept all the same.
  std::vector<JudgedPlan> refused = {{{away}, 0.005, {}}, {{away}, 0.001, {}}};
  judge.KeepBest(heap.view, 1, refused);
  EXPECT_EQ(refused[0].error_m, 0.001);
  EXPECT_EQ(refused[0].accepted, false);
}

TEST(StrokeProposal, StartsWhereSandLiesAboveTheGoal) {
  const Heap heap;
  const StrokeProposal proposal(heap.view, 1);
  RandomStream stream(1);
  for (int k = 0; k < 200; ++k) {
    const Action action = proposal.Draw(stream);  // the heap: x 60..140 mm, y 100..200 mm
    EXPECT_GE(action[0], -0.6f - 1e-5f);
    EXPECT_LE(action[0], -0.066f);
    EXPECT_GE(action[1], -0.334f);
    EXPECT_LE(action[1], 0.334f);
  }
  EXPECT_EQ(proposal.Draw(3, stream).size(), 3u);
}

TEST(PlanDistribution, HeadingsOnBothSidesOfPiHaveTheirMiddleThere) {
  std::vector<JudgedPlan> plans;
  for (float heading : {0.9f, -0.8f}) {
    plans.push_back({{Action{0.1f, 0, heading, 0, 0, 0, 0}}, 0, {}});
    plans.back().strokes.push_back(Action{heading, 0, 0, 0, 0, 0, 0});
  }
  PlanDistribution fit = PlanDistribution::Fit(plans);
  ASSERT_EQ(fit.mean.size(), 2u * kActionSize);
  EXPECT_NEAR(fit.mean[0], 0.1, 1e-7);
  EXPECT_NEAR(fit.sd[0], 0, 1e-7);
  EXPECT_NEAR(fit.mean[kHeadingEntry], -0.95, 1e-6);
  EXPECT_NEAR(fit.sd[kHeadingEntry], 0.15, 1e-6);
  EXPECT_NEAR(fit.mean[kActionSize], 0.05, 1e-7);  // a place does not go round
  EXPECT_NEAR(fit.sd[kActionSize], 0.85, 1e-6);
  // Half of the way from 0.95 to -0.95 goes over the seam.
  PlanDistribution from = fit;
  from.mean[kHeadingEntry] = 0.95;
  from.sd[kHeadingEntry] = 0.05;
  from.Approach(fit, 0.5);
  EXPECT_NEAR(std::abs(from.mean[kHeadingEntry]), 1, 1e-6);
  EXPECT_NEAR(from.sd[kHeadingEntry], 0.1, 1e-6);
  RandomStream stream(1);
  int positive = 0;
  for (int k = 0; k < 100; ++k) {
    const StrokePlan plan = fit.Draw(0, stream);
    ASSERT_EQ(plan.size(), 2u);
    EXPECT_NEAR(plan[0][0], 0.1, 1e-6);
    EXPECT_GT(std::abs(plan[0][kHeadingEntry]), 0.3f);
    EXPECT_LE(std::abs(plan[1][0]), 1.0f);
    positive += plan[0][kHeadingEntry] > 0;
  }
  EXPECT_GT(positive, 10);
  EXPECT_LT(positive, 90);
}

TEST(PlanningBudget, SpendsWhatItHasAndPlansNoFurtherThanTheTask) {
  const Heap heap;
  const PlanningBudget budget("cem", 150, 3, 4);
  EXPECT_EQ(budget.StrokesAhead(heap.view), 3u);
  EXPECT_THAT(budget.PlansByRound(3), ::testing::ElementsAre(12, 13, 12, 13));
  TaskView last = heap.view;
  last.strokes_used = 4;
  EXPECT_EQ(budget.StrokesAhead(last), 1u);
  EXPECT_THAT(budget.PlansByRound(1), ::testing::ElementsAre(37, 38, 37, 38));
}

}  // namespace
}  // namespace sandwright
