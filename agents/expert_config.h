// The numbers of expert iteration (expert_iteration.h); free of torch.
#pragma once

#include <string>

#include "data/base/config.h"

namespace sandwright {

struct ExpertConfig {
  int64_t num_steps = 8;
  int64_t evaluations = 64;
  double policy_share = 0.5, refine_share = 0.25;
  double temperature = 0.05;
  int64_t keep = 8;
  double expert_share = 0.5;
  int64_t buffer_size = 16384;
  int64_t gradient_steps = 16;
  int64_t minibatch_size = 256;
  double learning_rate = 1e-3;
  std::string learning_rate_schedule = "linear";
  double max_gradient_norm = 1.0;
  bool symmetry = true;

  void Fields(FieldList& f) {
    f.Add("num_steps", num_steps, "strokes of each environment in a round", 1, 1e6);
    f.Add("evaluations", evaluations, "strokes that the expert tries a stroke", 2, 100000);
    f.Add("policy_share", policy_share,
          "share of them drawn from the policy, beside those that start where sand lies above the goal",
          0, 1);
    f.Add("refine_share", refine_share, "share of them drawn around the best of the others", 0,
          0.95);
    f.Add("temperature", temperature,
          "of the weights of what is learnt: reward below the best at which one falls to 1/e", 1e-6,
          100);
    f.Add("keep", keep, "best strokes that a state is kept with", 1, 1000);
    f.Add("expert_share", expert_share,
          "how often the expert's stroke is executed; else the policy's, so that it learns where it "
          "goes itself",
          0, 1);
    f.Add("buffer_size", buffer_size, "newest states that are learnt from", 1, 1e7);
    f.Add("gradient_steps", gradient_steps, "a round", 1, 1e6);
    f.Add("minibatch_size", minibatch_size, "states in a gradient step", 1, 1e6);
    f.Add("learning_rate", learning_rate, "of Adam, at the start", 0, 1);
    f.Add("learning_rate_schedule", learning_rate_schedule, "over total_steps; linear ends at 0",
          {"linear", "constant"});
    f.Add("max_gradient_norm", max_gradient_norm, "gradients are scaled to at most this norm", 0,
          1e6);
    f.Add("symmetry", symmetry,
          "show each state mirrored (and, on a square region, turned) at random");
  }
};

}  // namespace sandwright
