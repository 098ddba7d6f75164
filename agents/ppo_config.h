// The numbers of PPO (ppo.h); free of torch.
#pragma once

#include <string>

#include "data/base/config.h"

namespace sandwright {

struct PpoConfig {
  int64_t num_steps = 32;
  int64_t epochs = 4;
  int64_t minibatch_size = 256;
  double gamma = 0.95, gae_lambda = 0.95;
  double learning_rate = 1e-3;
  std::string learning_rate_schedule = "linear";
  double clip_range = 0.2, value_clip_range = 0;
  std::string clip_range_schedule = "constant";
  double entropy_coefficient = 0.003, value_coefficient = 0.5;
  double max_gradient_norm = 0.5;
  double target_kl = 0.03;
  bool scale_rewards = false;
  double advantage_floor = 0.01;

  void Fields(FieldList& f) {
    f.Add("num_steps", num_steps, "steps of each environment in a rollout", 1, 1e6);
    f.Add("epochs", epochs, "passes over a rollout", 1, 1000);
    f.Add("minibatch_size", minibatch_size, "steps in a gradient step", 2, 1e6);
    f.Add("gamma", gamma, "discount", 0, 1);
    f.Add("gae_lambda", gae_lambda, "weight of longer advantage estimates", 0, 1);
    f.Add("learning_rate", learning_rate, "of Adam, at the start", 0, 1);
    f.Add("learning_rate_schedule", learning_rate_schedule,
          "over total_steps; linear ends at 0; adaptive: after an update that moved the policy by more than twice "
          "target_kl it falls by a third, by less than half of it grows by a half",
          {"linear", "constant", "adaptive"});
    f.Add("clip_range", clip_range, "of the probability ratio, at the start", 0, 1);
    f.Add("clip_range_schedule", clip_range_schedule, "over total_steps; linear ends at 0",
          {"linear", "constant"});
    f.Add("value_clip_range", value_clip_range, "of a value's change in an update; 0: unlimited", 0,
          1e6);
    f.Add("entropy_coefficient", entropy_coefficient, "reward a nat of the policy's entropy", 0,
          10);
    f.Add("value_coefficient", value_coefficient, "weight of the value loss", 0, 100);
    f.Add("max_gradient_norm", max_gradient_norm, "gradients are scaled to at most this norm", 0,
          1e6);
    f.Add("target_kl", target_kl, "an update stops where the policy moved 1.5 times this (not with the adaptive schedule, which aims at it); 0: never",
          0, 10);
    f.Add("scale_rewards", scale_rewards,
          "divide rewards by the running deviation of their discounted sum");
    f.Add("advantage_floor", advantage_floor,
          "advantages of a lesser deviation are not enlarged to 1: share of the running deviation of "
          "the rewards' discounted sum",
          0, 10);
  }
};

}  // namespace sandwright
