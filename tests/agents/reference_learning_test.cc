// The lowest rungs of the ladder (docs/agents.md), in the size of a test.
#include <gtest/gtest.h>

#include "agents/train.h"

namespace sandwright {
namespace {

double Score(const std::string& rung, int64_t total_steps) {
  TrainConfig config;
  LoadYaml(FieldsOf(config), SANDWRIGHT_ROOT "/configs/ladder/" + rung + ".yaml");
  config.total_steps = total_steps;
  config.evaluation_tasks = 20;
  const auto folder = std::filesystem::path(::testing::TempDir()) / rung;
  std::filesystem::remove_all(folder);
  return Train(config, {folder, 1, 1, false}).at("mean_reward");
}

TEST(ReferenceLearning, PpoHoldsThePole) { EXPECT_GT(Score("cart_pole_ppo", 50000), 400); }

TEST(ReferenceLearning, PpoSwingsTheAcrobotUp) { EXPECT_GT(Score("acrobot_ppo", 131072), -100); }

TEST(ReferenceLearning, PpoMakesTheCheetahRun) { EXPECT_GT(Score("half_cheetah_ppo", 61440), 700); }

TEST(ReferenceLearning, SacSwingsThePendulumUp) { EXPECT_GT(Score("pendulum_sac", 5000), -300); }

}  // namespace
}  // namespace sandwright
