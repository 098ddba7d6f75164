// Sizes of the actor-critic network (networks.h); free of torch.
#pragma once

#include <vector>

#include "data/base/config.h"

namespace sandwright {

struct NetworkConfig {
  int64_t channels = 16;  // of the finest features
  int64_t hidden = 64;
  int64_t headings = 16;
  int64_t blocks = 0;
  bool normalize = false;
  double surplus_first = 0;
  std::vector<double> first_guess = {};

  void Fields(FieldList& f) {
    f.Add("channels", channels, "feature channels at half the map's resolution, twice below", 1,
          256);
    f.Add("hidden", hidden, "width of the fully connected layers", 1, 4096);
    f.Add("headings", headings, "directions of travel that the policy tells apart", 1, 64);
    f.Add("blocks", blocks, "residual blocks that look along the sand at half the map's resolution", 0, 64);
    f.Add("normalize", normalize,
          "bring the observation's numbers to mean 0 and variance 1, as seen in training");
    f.Add(
        "surplus_first", surplus_first,
        "how much the untrained policy prefers to start on surplus sand: log probability per 10 mm",
        0, 20);
    f.Add("first_guess", first_guess,
          "means of length, depths and bend that the untrained policy starts from; empty: 0", -0.95,
          0.95);
  }
};

}  // namespace sandwright
