// What a run of several ranks keeps for the case that they cannot go on together.
#pragma once

#include <filesystem>

#include "agents/collective.h"
#include "data/base/error.h"
#include "env/safetensors.h"

namespace sandwright {

// Does nothing where there is one rank.
class RankGuard {
 public:
  RankGuard(Collective& ranks, std::filesystem::path folder)
      : ranks_(ranks), folder_(std::move(folder)) {}

  // Called after each update with what a checkpoint holds, the parameters among it; throws Error on all
  // ranks, naming what, where a rank has something else.
  void Keep(Safetensors complete, int64_t steps);
  // Leaves what was kept last as a checkpoint in the folder, one for all ranks that share it, and throws
  // `fault` with where that is.
  [[noreturn]] void Rescue(const Error& fault) const;

 private:
  Collective& ranks_;
  std::filesystem::path folder_;
  Safetensors complete_;
  int64_t steps_ = -1;  // none yet
};

}  // namespace sandwright
