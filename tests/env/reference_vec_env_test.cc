// Rows of the batch against single tasks; tests/python/test_reference.py holds them against Gymnasium's.
#include "env/reference/reference_vec_env.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "data/base/error.h"
#include "data/base/random.h"

namespace sandwright {
namespace {

using ::testing::Each;
using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(ReferenceVecEnv, RowsAreTheTasksOfTheirSeeds) {
  constexpr size_t kRows = 3;
  ReferenceVecEnv env("CartPole-v1", kRows);
  EXPECT_EQ(env.choices(), 2);
  EXPECT_EQ(env.action_size(), 1);
  const auto size = static_cast<size_t>(env.observation_spec().vec_size());
  std::vector<std::unique_ptr<ReferenceTask>> tasks;
  std::vector<NumpyRandom> randoms;
  std::vector<std::vector<float>> seen(kRows, std::vector<float>(size));
  ObservationBatch shown = env.Reset(11);
  for (size_t i = 0; i < kRows; ++i) {
    tasks.push_back(MakeReferenceTask("CartPole-v1"));
    randoms.emplace_back(11 + i);
    tasks[i]->Reset(randoms[i], seen[i]);
  }
  RandomStream stream(1, StreamId("test actions"));
  std::vector<int> lengths(kRows), ends(kRows);
  for (int step = 0; step < 200; ++step) {
    std::vector<float> actions(kRows);
    for (float& action : actions) action = static_cast<float>(stream.Index(2));
    const StepBatch batch = env.Step(actions);
    size_t finished = 0;
    for (size_t i = 0; i < kRows; ++i) {
      const ReferenceStep alone = tasks[i]->Step(std::span(actions).subspan(i, 1), seen[i]);
      ++lengths[i];
      EXPECT_EQ(batch.reward[i], static_cast<float>(alone.reward));
      EXPECT_EQ(batch.terminated[i], alone.terminated);
      EXPECT_EQ(batch.truncated[i], 0);
      const auto last = std::span(batch.final_observation.vec).subspan(i * size, size);
      if (alone.terminated) {
        EXPECT_THAT(last, ElementsAreArray(seen[i]));
        ASSERT_LT(finished, batch.finished.size());
        EXPECT_EQ(batch.finished[finished].length, lengths[i]);
        EXPECT_EQ(batch.finished[finished++].episode_return, lengths[i]);
        tasks[i]->Reset(randoms[i], seen[i]);  // goes on with its own numbers
        lengths[i] = 0;
        ++ends[i];
      } else {
        EXPECT_THAT(last, Each(0));
      }
      EXPECT_THAT(std::span(batch.observation.vec).subspan(i * size, size), ElementsAreArray(seen[i]));
    }
    EXPECT_EQ(finished, batch.finished.size());
  }
  EXPECT_THAT(ends, Each(::testing::Gt(2)));
}

TEST(ReferenceVecEnv, EpisodesAreCutOffAfterTheirSteps) {
  ReferenceVecEnv env("Pendulum-v1", 2);
  const std::vector<float> rest(2);
  for (int step = 1; step < 200; ++step) ASSERT_THAT(env.Step(rest).truncated, Each(0)) << step;
  const StepBatch last = env.Step(rest);
  EXPECT_THAT(last.truncated, Each(1));
  EXPECT_THAT(last.terminated, Each(0));
  ASSERT_EQ(last.finished.size(), 2u);
  EXPECT_EQ(last.finished[1].length, 200);
}

TEST(ReferenceVecEnv, ActionsAreSharesOfTheLimit) {
  ReferenceVecEnv env("Pendulum-v1", 1);
  const auto alone = MakeReferenceTask("Pendulum-v1");
  std::vector<float> seen(3);
  NumpyRandom random(0);
  alone->Reset(random, seen);
  alone->Step(std::vector<float>{1.5f}, seen);  // of 2 N m
  EXPECT_THAT(env.Step(std::vector<float>{0.75f}).observation.vec, ElementsAreArray(seen));
}

TEST(ReferenceVecEnv, ResultsDoNotDependOnTheThreadCount) {
  ReferenceVecEnv one("HalfCheetah-v5", 5, 1), three("HalfCheetah-v5", 5, 3);
  EXPECT_EQ(one.Reset(1).vec, three.Reset(1).vec);
  RandomStream stream(1, StreamId("test actions"));
  for (int step = 0; step < 50; ++step) {
    std::vector<float> actions(5 * 6);
    for (float& action : actions) action = static_cast<float>(stream.Uniform(-1, 1));
    const StepBatch a = one.Step(actions), b = three.Step(actions);
    ASSERT_EQ(a.observation.vec, b.observation.vec);
    ASSERT_EQ(a.reward, b.reward);
  }
}

TEST(ReferenceVecEnv, BadInputIsRefusedAndChangesNothing) {
  EXPECT_THAT([] { ReferenceVecEnv("Sandpit-v0", 1); }, ThrowsMessage<Error>(HasSubstr("unknown task")));
  EXPECT_THAT([] { ReferenceVecEnv("Hopper-v5", 0); }, ThrowsMessage<Error>(HasSubstr("0 environments")));
  EXPECT_THAT([] { ReferenceVecEnv("Hopper-v5", 1, 0); }, ThrowsMessage<Error>(HasSubstr("0 threads")));
  ReferenceVecEnv env("Hopper-v5", 2), other("Hopper-v5", 2);
  std::vector<float> actions(2 * 3);
  EXPECT_THROW(env.Step(std::span(actions).first(5)), Error);
  actions[5] = std::nanf("");
  EXPECT_THAT([&] { env.Step(actions); }, ThrowsMessage<Error>(HasSubstr("Hopper-v5: action nan")));
  actions[5] = 1;
  other.Reset(0);
  EXPECT_EQ(env.Step(actions).observation.vec, other.Step(actions).observation.vec);
}

}  // namespace
}  // namespace sandwright
