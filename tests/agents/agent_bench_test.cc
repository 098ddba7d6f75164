#include "agents/agent_bench.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "data/base/error.h"
#include "env/heightfield.h"
#include "env/task_generator.h"

namespace sandwright {
namespace {

TEST(MeanWithInterval, CoversTheMeanAndShrinksWithTheTasks) {
  std::vector<double> few = {1, 2, 3, 4}, many;
  for (int i = 0; i < 100; ++i) many.insert(many.end(), few.begin(), few.end());
  const MeanOverTasks a = MeanWithInterval(few, 1), b = MeanWithInterval(many, 1);
  EXPECT_DOUBLE_EQ(a.mean, 2.5);
  EXPECT_LT(a.low95, 2.5);
  EXPECT_GT(a.high95, 2.5);
  // The standard error falls with the root of the number; sd 1.118, 1.96 of it to each side.
  EXPECT_NEAR(b.high95 - b.low95, 2 * 1.96 * 1.118 / 20, 0.02);
  const MeanOverTasks same = MeanWithInterval(std::vector<double>{3, 3, 3}, 1);
  EXPECT_DOUBLE_EQ(same.low95, 3);
  EXPECT_DOUBLE_EQ(same.high95, 3);
}

TEST(AgentBench, ComparesTaskByTask) {
  const Heightfield sand{HeightfieldConfig{}};
  AgentBench bench{.agents = {"greedy@20", "random", "sweep"}, .tasks = {}, .seed = 5};
  for (uint64_t i = 0; i < 4; ++i) {
    RandomStream stream(1, kEvaluationTasks, i);
    bench.tasks.push_back(GenerateTask({.cell_size_m = 0.02, .max_strokes = 6}, stream));
  }
  std::vector<AgentBenchRow> rows;
  const World world{sand};
  RunAgentBench(bench, {.model = sand}, world, [&](const AgentBenchRow& row) { rows.push_back(row); });
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].model_evaluations_per_stroke, 20);
  EXPECT_EQ(rows[1].model_evaluations_per_stroke, 0);
  EXPECT_EQ(rows[0].above_first_mm[2].high95, 0);
  for (size_t k = 0; k < 3; ++k) {
    double mean = 0;
    for (size_t i = 0; i < 4; ++i)
      mean += (rows[1].per_task_mm[i][k] - rows[0].per_task_mm[i][k]) / 4;
    EXPECT_NEAR(rows[1].above_first_mm[k].mean, mean, 1e-9);
  }
  EXPECT_GT(rows[1].above_first_mm[2].low95, 0);  // random is worse than greedy, whatever the tasks
  EXPECT_GT(rows[1].error_mm[2].mean, rows[2].error_mm[2].mean);
}

TEST(AgentBench, BudgetsThatMakeNoSenseAreNamed) {
  const Heightfield sand{HeightfieldConfig{}};
  const World world{sand};
  for (const std::string agent : {"cem@", "cem@x", "cem@0", "cem@5x", "sweep@10", "@10"}) {
    AgentBench bench{.agents = {agent}, .tasks = {}};
    EXPECT_THAT([&] { RunAgentBench(bench, {.model = sand}, world, {}); },
                ::testing::ThrowsMessage<Error>(::testing::HasSubstr("agent \"" + agent + "\"")))
        << agent;
  }
}

}  // namespace
}  // namespace sandwright
