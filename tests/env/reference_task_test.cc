// Golden vectors of Gymnasium 1.4.0; tests/python/test_reference.py steps both side by side.
#include "env/reference/reference_task.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "data/base/error.h"
#include "env/reference/numpy_normal.h"

namespace sandwright {
namespace {

using ::testing::FloatNear;
using ::testing::HasSubstr;
using ::testing::Pointwise;
using ::testing::ThrowsMessage;

std::vector<float> Reset(ReferenceTask& task, uint64_t seed) {
  std::vector<float> observation(task.spec().observation.size());
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
  const ReferenceStep step = task->Step(V{1}, seen);
  EXPECT_THAT(seen, Pointwise(FloatNear(6e-9f), V{0.02727336f, 0.18847767f, 0.03625453f, -0.26141977f}));
  EXPECT_EQ(step.reward, 1);
  EXPECT_FALSE(step.terminated);
}

TEST(ReferenceTask, ThePoleFallsInTheEnd) {
  const auto task = MakeReferenceTask("CartPole-v1");
  std::vector<float> seen = Reset(*task, 1);
  int steps = 1;
  while (!task->Step(std::vector<float>{1}, seen).terminated) ++steps;
  EXPECT_LT(steps, 12);
  EXPECT_GT(std::abs(seen[2]), 0.2f);
}

// What the planar bodies show after a reset is the model's pose with the draws added to it.
TEST(ReferenceTask, BodiesStartFromTheirPoseAndNoise) {
  NumpyRandom random(7);
  random.Uniform(0, 1);  // the way along x is not shown
  const float height_m = static_cast<float>(1.25 + random.Uniform(-0.005, 0.005));
  EXPECT_EQ(Reset(*MakeReferenceTask("Hopper-v5"), 7)[0], height_m);

  random = NumpyRandom(7);
  for (int joint = 0; joint < 9; ++joint) random.Uniform(0, 1);
  const float speed_mps = static_cast<float>(0.1 * StandardNormal(random));
  EXPECT_EQ(Reset(*MakeReferenceTask("HalfCheetah-v5"), 7)[8], speed_mps);
}

TEST(ReferenceTask, UnknownNamesAndChoicesAreRefused) {
  EXPECT_THAT([] { MakeReferenceTask("Sandpit-v0"); },
              ThrowsMessage<Error>(HasSubstr("unknown task 'Sandpit-v0'")));
  const auto check = [](const char* name, std::vector<float> action) {
    return [=] { CheckAction(MakeReferenceTask(name)->spec(), action); };
  };
  EXPECT_THAT(check("Acrobot-v1", {3}), ThrowsMessage<Error>(HasSubstr("allowed: 0..2")));
  EXPECT_THAT(check("Acrobot-v1", {0.5f}), ThrowsMessage<Error>(HasSubstr("action 0.5")));
  EXPECT_THAT(check("Acrobot-v1", {-1}), ThrowsMessage<Error>(HasSubstr("action -1")));
  EXPECT_THAT(check("Hopper-v5", {0, 0, std::nanf("")}), ThrowsMessage<Error>(HasSubstr("action nan")));
  EXPECT_NO_THROW(check("Acrobot-v1", {2})());
  EXPECT_NO_THROW(check("Hopper-v5", {0, -3, 1})());
}

}  // namespace
}  // namespace sandwright
