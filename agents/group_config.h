// The numbers of the group policy gradient (group_gradient.h); free of torch.
#pragma once

#include <string>

#include "data/base/config.h"

namespace sandwright {

struct GroupConfig {
  int64_t num_steps = 10;
  int64_t strokes = 64;
  double seek = 0.5;
  double best_share = 0.5;
  int64_t gradient_steps = 10;
  int64_t minibatch_size = 256;
  double clip_range = 0.2;
  double learning_rate = 7e-4;
  std::string learning_rate_schedule = "linear";
  double max_gradient_norm = 1.0;

  void Fields(FieldList& f) {
    f.Add("num_steps", num_steps, "strokes of each environment in a round", 1, 1e6);
    f.Add("strokes", strokes, "that the policy draws and the sand model tries in a state", 2, 100000);
    f.Add("seek", seek,
          "deviations of a state's rewards by which a stroke must be better to count e times as much; 0: rewards "
          "count as they are",
          0, 100);
    f.Add("best_share", best_share,
          "how often the best of the strokes is executed; else the policy's most probable one, so that it learns "
          "where it goes itself",
          0, 1);
    f.Add("gradient_steps", gradient_steps, "a round", 1, 1e6);
    f.Add("minibatch_size", minibatch_size, "states in a gradient step, each with all its strokes", 1, 1e6);
    f.Add("clip_range", clip_range, "ratios of probabilities count within 1 +- this", 0.001, 1);
    f.Add("learning_rate", learning_rate, "of Adam, at the start", 0, 1);
    f.Add("learning_rate_schedule", learning_rate_schedule, "over total_steps; linear ends at 0",
          {"linear", "constant"});
    f.Add("max_gradient_norm", max_gradient_norm, "gradients are scaled to at most this norm", 0, 1e6);
  }
};

}  // namespace sandwright
