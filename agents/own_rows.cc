#include "agents/own_rows.h"

#include <algorithm>

namespace sandwright {

OwnRows::OwnRows(std::span<const int64_t> order, int64_t envs, const Collective& ranks) {
  const int64_t all = envs * ranks.size(), first = envs * ranks.rank();
  for (int64_t i = 0; i < std::ssize(order); ++i) {
    const int64_t step = order[static_cast<size_t>(i)] / all,
                  env = order[static_cast<size_t>(i)] % all - first;
    if (env < 0 || env >= envs) continue;
    position.push_back(i);
    row.push_back(step * envs + env);
  }
}

int64_t OwnRows::Before(int64_t end) const {
  return std::ranges::lower_bound(position, end) - position.begin();
}

}  // namespace sandwright
