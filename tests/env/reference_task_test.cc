// Golden vectors of Gymnasium 1.4.0; tests/python/test_reference.py steps both side by side.
#include "env/reference/reference_task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data/base/error.h"

namespace sandwright {
namespace {

using ::testing::FloatNear;
using ::testing::HasSubstr;
using ::testing::Pointwise;
using ::testing::ThrowsMessage;

std::vector<float> Reset(ReferenceTask& task, uint64_t seed) {
  std::vector<float> observation(static_cast<size_t>(task.spec().observation_size));
  NumpyRandom random(seed);
  task.Reset(random, observation);
  return observation;
}

TEST(ReferenceTask, CartPoleStartsAndStepsAsGymnasiums) {
  const auto task = MakeReferenceTask("CartPole-v1");
  using V = std::vector<float>;
  EXPECT_THAT(Reset(*task, 43), Pointwise(FloatNear(6e-9f), V{0.01522993f, -0.04562247f, -0.04799704f, 0.03392126f}));
  EXPECT_THAT(Reset(*task, 44), Pointwise(FloatNear(6e-9f), V{-0.03774345f, -0.02418869f, -0.00942293f, 0.0469184f}));
  EXPECT_THAT(Reset(*task, 123), Pointwise(FloatNear(6e-9f), V{0.01823519f, -0.0446179f, -0.02796401f, -0.03156282f}));
  V seen = Reset(*task, 42);
  EXPECT_THAT(seen, Pointwise(FloatNear(6e-9f), V{0.0273956f, -0.00611216f, 0.03585979f, 0.0197368f}));
  const ReferenceStep step = task->Step(1, seen);
  EXPECT_THAT(seen, Pointwise(FloatNear(6e-9f), V{0.02727336f, 0.18847767f, 0.03625453f, -0.26141977f}));
  EXPECT_EQ(step.reward, 1);
  EXPECT_FALSE(step.terminated);
}

TEST(ReferenceTask, ThePoleFallsInTheEnd) {
  const auto task = MakeReferenceTask("CartPole-v1");
  std::vector<float> seen = Reset(*task, 1);
  int steps = 1;
  while (!task->Step(1, seen).terminated) ++steps;
  EXPECT_LT(steps, 12);
  EXPECT_GT(std::abs(seen[2]), 0.2f);
}

TEST(ReferenceTask, UnknownNamesAndChoicesAreRefused) {
  EXPECT_THAT([] { MakeReferenceTask("Sandpit-v0"); },
              ThrowsMessage<Error>(HasSubstr("unknown task 'Sandpit-v0'")));
  const auto task = MakeReferenceTask("Acrobot-v1");
  std::vector<float> seen = Reset(*task, 1);
  EXPECT_THAT([&] { task->Step(3, seen); }, ThrowsMessage<Error>(HasSubstr("allowed: 0..2")));
  EXPECT_THAT([&] { task->Step(0.5f, seen); }, ThrowsMessage<Error>(HasSubstr("action 0.5")));
}

}  // namespace
}  // namespace sandwright
