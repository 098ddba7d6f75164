// The numbers of SAC (sac.h) and of what TQC (tqc.h) adds; free of torch.
#pragma once

#include "data/base/config.h"

namespace sandwright {

// Of actor and critics.
struct SacNetworkConfig {
  int64_t hidden = 256;
  int64_t channels = 16, features = 64;

  void Fields(FieldList& f) {
    f.Add("hidden", hidden, "width of the two hidden layers of actor and critics", 1, 4096);
    f.Add("channels", channels, "feature channels of a map at half its resolution, twice below", 1, 256);
    f.Add("features", features, "numbers that a map becomes", 1, 4096);
  }
};

struct SacConfig {
  double learning_rate = 3e-4;
  double gamma = 0.99, target_share = 0.005;
  int64_t batch_size = 256, buffer_size = 1000000;
  int64_t random_steps = 100;
  int64_t train_every = 1, gradient_steps = 1;
  int64_t n_step = 1;
  bool symmetry = true;
  SacNetworkConfig network;
  double temperature = 0;
  double noise_color = 0;

  void Fields(FieldList& f) {
    f.Add("learning_rate", learning_rate, "of Adam: actor, critics and temperature", 0, 1);
    f.Add("gamma", gamma, "discount", 0, 1);
    f.Add("target_share", target_share, "step of the target critics towards the critics", 0, 1);
    f.Add("batch_size", batch_size, "transitions in a gradient step", 1, 1e6);
    f.Add("buffer_size", buffer_size, "transitions kept", 1, 1e9);
    f.Add("random_steps", random_steps, "steps with uniform actions before anything is learnt", 1,
          1e9);
    f.Add("train_every", train_every, "steps of each environment between gradient steps", 1, 1e6);
    f.Add("gradient_steps", gradient_steps, "gradient steps then", 1, 1e6);
    f.Add("n_step", n_step, "steps whose rewards a target takes as they came, before it estimates the rest", 1,
          1000);
    f.Add("symmetry", symmetry, "learn each batch of strokes mirrored or turned; the arm is neither");
    network.Fields(f);
    f.Add("temperature", temperature,
          "reward a nat of entropy; 0: learnt, for an entropy of minus the action's size", 0, 1e3);
    f.Add("noise_color", noise_color,
          "of exploration: power falls with frequency to minus this; 0: white, 1: pink", 0, 2);
  }
};

struct TqcConfig {
  int64_t critics = 2, quantiles = 25, dropped = 2;

  void Fields(FieldList& f) {
    f.Add("critics", critics, "in the ensemble", 1, 100);
    f.Add("quantiles", quantiles, "of the return that a critic gives", 1, 1000);
    f.Add("dropped", dropped, "greatest quantiles a critic that the target leaves out", 0, 999);
  }
};

}  // namespace sandwright
