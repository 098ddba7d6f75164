// What every environment must do, on every sand model there is.
#include "env/shaping_env.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numeric>

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

// The sand's cells, the observation's and the region are three choices.
TEST_P(Conformance, SandObservationAndRegionHaveGridsOfTheirOwn) {
  TaskConfig tasks;
  tasks.width_m = 1.2;
  tasks.depth_m = 0.8;
  tasks.cell_size_m = 0.01;
  tasks.goal_width_m = 0.3;
  tasks.goal_depth_m = 0.2;
  tasks.terrain.amplitude_m = 0.02;
  ShapingConfig config = SmallConfig();
  config.random_phase = false;
  config.observation.rows = 24;
  config.observation.columns = 40;
  config.episode.region_width_m = 0.4;
  config.episode.region_depth_m = 0.25;
  ShapingEnv env(config, {.sand = *sand_}, TasksFrom(tasks));
  EXPECT_EQ(env.observation_spec().map_size(), 5 * 24 * 40);
  const ObservationBatch seen = env.Reset(3);
  ASSERT_EQ(seen.map.size(), size_t{5 * 5 * 24 * 40});
  const ShapingEnv::State state = env.state();
  for (size_t i = 0; i < 5; ++i) {
    const EpisodeState& episode = state.episodes[i];
    EXPECT_EQ(episode.sand.map().rows, 80);
    EXPECT_EQ(episode.sand.map().columns, 120);
    EXPECT_NEAR(episode.region.width_m, 0.4, 1e-12);
    EXPECT_NEAR(episode.region.depth_m, 0.25, 1e-12);
    // Channel 3 is the mask: the goal's 300 x 200 mm of the region's 400 x 250 mm.
    const auto mask = seen.map.begin() + static_cast<std::ptrdiff_t>((i * 5 + 3) * 24 * 40);
    EXPECT_NEAR(std::accumulate(mask, mask + 24 * 40, 0.0) / (24 * 40), 0.6, 1e-5);
  }
  RandomStream stream(3);
  const StepBatch step = env.Step(RandomActions(5, stream));
  ASSERT_EQ(step.observation.map.size(), seen.map.size());
  for (float x : step.observation.map) EXPECT_LT(std::abs(x), 10);
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

std::vector<float> Row(const ObservationBatch& batch, const ObservationSpec& spec, int row) {
  const auto at = batch.map.begin() + row * spec.map_size();
  std::vector<float> values(at, at + spec.map_size());
  const auto numbers = batch.vec.begin() + row * spec.vec_size();
  values.insert(values.end(), numbers, numbers + spec.vec_size());
  return values;
}

TEST(ShapingEnv, ARowWithASeedOfItsOwnIsAnEnvironmentAlone) {
  const Heightfield sand;
  ShapingConfig single = SmallConfig();
  single.num_envs = 1;
  ShapingEnv alone(single, {.sand = sand}, TasksFrom(SmallTasks()));
  ShapingEnv many(SmallConfig(), {.sand = sand, .threads = 2}, TasksFrom(SmallTasks()));
  const ObservationSpec& spec = many.observation_spec();
  const ObservationBatch before = many.Reset(3);
  std::vector<std::optional<uint64_t>> seeds(5);
  seeds[2] = 77;
  const std::vector<uint8_t> chosen = {0, 0, 1, 0, 1};
  ObservationBatch shown = many.Reset(chosen, seeds), own = alone.Reset(77);
  EXPECT_EQ(Row(shown, spec, 2), Row(own, spec, 0));
  EXPECT_EQ(Row(shown, spec, 0), Row(before, spec, 0));
  EXPECT_NE(Row(shown, spec, 4), Row(before, spec, 4));  // its next episode
  RandomStream stream(5);
  for (int k = 0; k < 9; ++k) {
    const std::vector<float> actions = RandomActions(5, stream);
    const StepBatch batch = many.Step(actions);
    const StepBatch one = alone.Step(std::span(actions).subspan(2 * kActionSize, kActionSize));
    EXPECT_EQ(Row(batch.observation, spec, 2), Row(one.observation, spec, 0)) << k;
    EXPECT_EQ(batch.reward[2], one.reward[0]);
  }
}

TEST(ShapingEnv, ARestoredStateGoesOnBitForBit) {
  const Heightfield sand;
  ShapingConfig config = SmallConfig();
  config.episode.sensor = {.noise_m = 0.001, .registration_m = 0.002, .hole_share = 0.02};
  config.episode.tracking_error_m = 0.001;
  ShapingEnv env(config, {.sand = sand}, TasksFrom(SmallTasks()));
  ShapingEnv other(config, {.sand = sand}, TasksFrom(SmallTasks()));
  RandomStream stream(6);
  env.Reset(4);
  for (int k = 0; k < 3; ++k) env.Step(RandomActions(5, stream));
  other.Restore(env.state());
  EXPECT_EQ(env.Observe().map, other.Observe().map);
  for (int k = 0; k < 6; ++k) {
    const std::vector<float> actions = RandomActions(5, stream);
    const StepBatch a = env.Step(actions), b = other.Step(actions);
    EXPECT_EQ(a.observation.map, b.observation.map);
    EXPECT_EQ(a.reward, b.reward);
  }
}

TEST(ShapingEnv, TheNextStepAfterAnEndStartsAnew) {
  const Heightfield sand;
  ShapingConfig config = SmallConfig();
  config.random_phase = false;
  ShapingEnv same(config, {.sand = sand}, TasksFrom(SmallTasks()));
  ShapingEnv next(config, {.sand = sand}, TasksFrom(SmallTasks()), Autoreset::kNextStep);
  RandomStream stream(7);
  same.Reset(8), next.Reset(8);
  StepBatch a, b;
  for (int k = 0; k < 4; ++k) {
    const std::vector<float> actions = RandomActions(5, stream);
    a = same.Step(actions), b = next.Step(actions);
    EXPECT_EQ(a.reward, b.reward);
    EXPECT_EQ(a.terminated, b.terminated);
  }
  EXPECT_EQ(b.terminated, std::vector<uint8_t>(5, 1));
  EXPECT_EQ(b.finished.size(), 5u);
  EXPECT_EQ(b.observation.map, a.final_observation.map);
  b = next.Step(RandomActions(5, stream));
  EXPECT_EQ(b.observation.map, a.observation.map);
  EXPECT_EQ(b.reward, std::vector<float>(5, 0));
  EXPECT_EQ(b.terminated, std::vector<uint8_t>(5, 0));
  EXPECT_TRUE(b.finished.empty());
  EXPECT_FALSE(next.results()[0].has_value());
}

TEST(ShapingEnv, WithoutAutoresetAStepAfterTheEndIsRefused) {
  const Heightfield sand;
  ShapingConfig config = SmallConfig();
  config.random_phase = false;
  ShapingEnv env(config, {.sand = sand}, TasksFrom(SmallTasks()), Autoreset::kDisabled);
  RandomStream stream(8);
  env.Reset(9);
  for (int k = 0; k < 4; ++k) env.Step(RandomActions(5, stream));
  const ObservationBatch end = env.Observe();
  EXPECT_THAT([&] { env.Step(RandomActions(5, stream)); },
              ThrowsMessage<Error>(HasSubstr("reset it before a step")));
  EXPECT_EQ(env.Observe().map, end.map);
  env.Reset(std::vector<uint8_t>(5, 1), std::vector<std::optional<uint64_t>>(5));
  env.Step(RandomActions(5, stream));
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
