#include "env/random_steps.h"

#include <gtest/gtest.h>

#include "env/load_gate.h"
#include "env/mixed_sand.h"
#include "tests/support/needle_sand.h"

namespace sandwright {
namespace {

ShapingConfig NoisyConfig() {
  ShapingConfig config{.num_envs = 8, .random_phase = false, .episode = {}, .observation = {}};
  config.episode.sensor = {.noise_m = 0.0004,
                           .registration_m = 0.002,
                           .offset_m = 0.001,
                           .hole_share = 0.01};
  config.episode.tracking_error_m = 0.001;
  config.observation.reach = true;
  return config;
}

TEST(RandomSteps, AreSoundWithEveryFaultOn) {
  const MixedSand sand = RandomSand({}, {.variants = 5});
  const auto gate = LoadGate("workcell_small.yaml");
  ShapingEnv env(NoisyConfig(), {.sand = sand, .gate = gate.get(), .threads = 2},
                 TasksFrom(TaskConfig{}));
  const RandomStepTally tally = RunRandomSteps(env, 1000, 1);
  EXPECT_EQ(tally.steps, 1000);
  EXPECT_GT(tally.episodes, 50);
  EXPECT_GT(tally.rejected, 100);
  EXPECT_LT(tally.rejected, 900);
  EXPECT_TRUE(tally.sound()) << tally.ToJson();
  ShapingEnv again(NoisyConfig(), {.sand = sand, .gate = gate.get()}, TasksFrom(TaskConfig{}));
  EXPECT_EQ(RunRandomSteps(again, 1000, 1).ToJson(), tally.ToJson());
}

TEST(RandomSteps, SeeWhatIsBroken) {
  ShapingConfig config = NoisyConfig();
  config.episode = {};
  const NeedleSand high(100);
  ShapingEnv env(config, {.sand = high}, TasksFrom(TaskConfig{}));
  EXPECT_GT(RunRandomSteps(env, 8, 1).out_of_bounds, 0);
}

}  // namespace
}  // namespace sandwright
