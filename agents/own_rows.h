// Which rows of a rollout of several ranks are this rank's.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "agents/collective.h"

namespace sandwright {

struct OwnRows {
  // Of `order`, rows of [T, ranks * envs] in any order, those of this rank's environments.
  OwnRows(std::span<const int64_t> order, int64_t envs, const Collective& ranks);

  std::vector<int64_t> position;  // in `order`, rising
  std::vector<int64_t> row;       // the same in this rank's own rollout [T, envs]

  // How many of them lie before a position.
  int64_t Before(int64_t end) const;
};

}  // namespace sandwright
