// The keys of the planner `ranked`, readable without torch.
#pragma once

#include <string>

#include "data/base/config.h"

namespace sandwright {

struct RankedConfig {
  std::string policy = "sampler";
  int64_t evaluations = 150;
  double refine_share = 0.4;

  void Fields(FieldList& f) {
    f.Add("policy", policy,
          "the policy: sampler (shipped to be ranked: its samples differ more), default, walled or a .safetensors file");
    f.Add("evaluations", evaluations,
          "model evaluations a stroke: the policy's own choice, samples of it, and refined ones", 1,
          100000);
    f.Add("refine_share", refine_share, "share of them drawn around the best of the others", 0,
          0.95);
  }
};

}  // namespace sandwright
