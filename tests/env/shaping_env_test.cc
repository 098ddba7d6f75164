// What every environment must do, on every sand model there is.
#include "env/shaping_env.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "env/heightfield.h"

namespace sandwright {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::unique_ptr<SandModel> MakeSand(const std::string& name) {
  if (name == "heightfield") return std::make_unique<Heightfield>();
  return std::make_unique<StillSand>();
}

ShapingConfig SmallConfig() {
  ShapingConfig config;
  config.num_envs = 5;
  config.observation.rows = config.observation.columns = 16;
  return config;
}

TaskConfig SmallTasks() {
  TaskConfig config;
  config.max_strokes = 4;
  return config;
}

std::vector<float> RandomActions(int n, RandomStream& stream) {
  std::vector<float> actions(static_cast<size_t>(n * kActionSize));
  for (float& a : actions) a = static_cast<float>(stream.Uniform(-1, 1));
  return actions;
}

// Everything that a run shows, for comparison byte by byte.
struct Trace {
  std::vector<float> numbers;
  std::vector<uint8_t> ends;
  bool operator==(const Trace&) const = default;
};

Trace Record(ShapingEnv& env, uint64_t seed, int steps) {
  Trace trace;
  const auto append = [&](const std::vector<float>& values) {
    trace.numbers.insert(trace.numbers.end(), values.begin(), values.end());
  };
  RandomStream stream(seed, StreamId("actions"));
  const ObservationBatch first = env.Reset(seed);
  append(first.map);
  append(first.vec);
  for (int k = 0; k < steps; ++k) {
    const StepBatch step = env.Step(RandomActions(env.num_envs(), stream));
    for (const auto* values :
         {&step.observation.map, &step.observation.vec, &step.final_observation.map,
          &step.final_observation.vec, &step.reward})
      append(*values);
    trace.ends.insert(trace.ends.end(), step.terminated.begin(), step.terminated.end());
    trace.ends.insert(trace.ends.end(), step.truncated.begin(), step.truncated.end());
  }
  return trace;
}

class Conformance : public ::testing::TestWithParam<const char*> {
 protected:
  ShapingEnv Make(ShapingConfig config = SmallConfig(), int threads = 1) const {
    return ShapingEnv(config, {.sand = *sand_, .threads = threads}, TasksFrom(SmallTasks()));
  }
  std::unique_ptr<SandModel> sand_ = MakeSand(GetParam());
};

TEST_P(Conformance, ShapesAndRanges) {
  ShapingEnv env = Make();
  const size_t n = 5;
  const auto map = static_cast<size_t>(env.observation_spec().map_size());
  const auto vec = static_cast<size_t>(env.observation_spec().vec_size());
  EXPECT_EQ(env.action_size(), 7);
  const auto check = [&](const ObservationBatch& batch) {
    ASSERT_EQ(batch.map.size(), n * map);
    ASSERT_EQ(batch.vec.size(), n * vec);
    for (float x : batch.map) EXPECT_LT(std::abs(x), 10);
    for (float x : batch.vec) EXPECT_TRUE(x >= 0 && x < 10) << x;
  };
  check(env.Reset(1));
  RandomStream stream(1);
  for (int k = 0; k < 12; ++k) {
    const StepBatch step = env.Step(RandomActions(5, stream));
    check(step.observation);
    check(step.final_observation);
    EXPECT_EQ(step.reward.size(), n);
    EXPECT_EQ(step.terminated.size(), n);
    EXPECT_EQ(step.truncated.size(), n);
    for (float r : step.reward) EXPECT_LT(std::abs(r), 20);
  }
}

TEST_P(Conformance, SameSeedSameBytesWhateverTheThreads) {
  ShapingEnv one = Make(), four = Make(SmallConfig(), 4);
  const Trace trace = Record(one, 11, 9);
  EXPECT_EQ(trace, Record(four, 11, 9));
  EXPECT_EQ(trace, Record(one, 11, 9));  // nothing is left over from an earlier run
  EXPECT_NE(trace, Record(one, 12, 9));
}

TEST_P(Conformance, BudgetEndsEpisodesAndTheRowGoesOnAnew) {
  ShapingConfig config = SmallConfig();
  config.random_phase = false;
  ShapingEnv env = Make(config);
  env.Reset(2);
  RandomStream stream(2);
  for (int k = 1; k <= 8; ++k) {
    const StepBatch step = env.Step(RandomActions(5, stream));
    const bool end = k % 4 == 0;
    EXPECT_EQ(step.finished.size(), end ? 5u : 0u);
    const auto vec = static_cast<size_t>(env.observation_spec().vec_size());
    for (size_t i = 0; i < 5; ++i) {
      EXPECT_EQ(step.terminated[i], end);
      EXPECT_EQ(step.truncated[i], 0);
      EXPECT_FLOAT_EQ(step.observation.vec[i * vec + 1], end ? 0 : static_cast<float>(k % 4) / 4);
      EXPECT_FLOAT_EQ(step.final_observation.vec[i * vec + 1], end ? 1 : 0);
    }
    for (const EpisodeSummary& summary : step.finished) {
      EXPECT_EQ(summary.length, 4);
      EXPECT_EQ(summary.metrics.at("strokes"), 4);
      EXPECT_EQ(summary.metrics.at("rejected_strokes"), 0);
    }
  }
}

TEST_P(Conformance, RewardsAddUpToTheDropOfTheError) {
  ShapingConfig config = SmallConfig();
  config.random_phase = false;
  config.episode.reward = {
      .per_mm = 1, .stroke_cost = 0, .outside_cost_per_cm3 = 0, .rejected_cost = 0};
  ShapingEnv env = Make(config);
  env.Reset(3);
  RandomStream stream(3);
  for (int k = 1; k < 4; ++k) env.Step(RandomActions(5, stream));
  for (const EpisodeSummary& summary : env.Step(RandomActions(5, stream)).finished)
    EXPECT_NEAR(summary.episode_return,
                summary.metrics.at("in_goal_mean_diff_start_mm") -
                    summary.metrics.at("in_goal_mean_diff_mm"),
                1e-9);
}

INSTANTIATE_TEST_SUITE_P(SandModels, Conformance, ::testing::Values("none", "heightfield"),
                         [](const auto& param) { return std::string(param.param); });

TEST(ShapingEnv, OutsideLimitTruncates) {
  const StillSand sand;
  ShapingConfig config = SmallConfig();
  config.random_phase = false;
  config.episode.truncate_after_strokes = 2;
  ShapingEnv env(config, {.sand = sand}, TasksFrom(SmallTasks()));
  RandomStream stream(4);
  EXPECT_EQ(env.Step(RandomActions(5, stream)).finished.size(), 0u);
  const StepBatch step = env.Step(RandomActions(5, stream));
  EXPECT_THAT(step.truncated, ::testing::Each(1));
  EXPECT_THAT(step.terminated, ::testing::Each(0));
  EXPECT_EQ(step.finished.size(), 5u);
}

TEST(ShapingEnv, RandomPhaseSpreadsTheFirstEnds) {
  const StillSand sand;
  ShapingConfig config = SmallConfig();
  config.num_envs = 40;
  ShapingEnv env(config, {.sand = sand}, TasksFrom(SmallTasks()));
  RandomStream stream(5);
  for (int k = 0; k < 4; ++k) {
    const size_t ends = env.Step(RandomActions(40, stream)).finished.size();
    EXPECT_GT(ends, 2u);
    EXPECT_LT(ends, 20u);
  }
}

TEST(ShapingEnv, FixedTasksAreAllDrawn) {
  const StillSand sand;
  std::vector<Task> tasks;
  for (uint64_t k = 0; k < 3; ++k) {
    RandomStream stream(6, kEvaluationTasks, k);
    tasks.push_back(GenerateTask(SmallTasks(), stream));
  }
  ShapingConfig config = SmallConfig();
  config.num_envs = 30;
  ShapingEnv env(config, {.sand = sand}, TasksFrom(tasks));
  std::vector<int> drawn(3);
  for (const EpisodeState& episode : env.episodes())
    for (size_t k = 0; k < 3; ++k)
      drawn[k] += episode.task->terrain.height_m == tasks[k].terrain.height_m;
  EXPECT_THAT(drawn, ::testing::Each(::testing::Gt(2)));
  EXPECT_EQ(drawn[0] + drawn[1] + drawn[2], 30);
}

TEST(ShapingEnv, BadActionThrowsBeforeAnythingChanges) {
  const Heightfield sand;
  ShapingEnv env(SmallConfig(), {.sand = sand}, TasksFrom(SmallTasks()));
  std::vector<float> actions(35, 0.0f);
  actions[34] = std::nanf("");
  const std::vector<float> before = env.episodes()[0].sand.map().height_m;
  const int used = env.episodes()[0].budget_used;
  EXPECT_THAT([&] { env.Step(actions); },
              ThrowsMessage<Error>(HasSubstr("action[6] (bend) = nan")));
  EXPECT_EQ(env.episodes()[0].sand.map().height_m, before);
  EXPECT_EQ(env.episodes()[0].budget_used, used);
  EXPECT_THROW(env.Step(std::vector<float>(34)), Error);
}

}  // namespace
}  // namespace sandwright
