// The rival that anything must beat: uniform actions.
#pragma once

#include "env/agent.h"

namespace sandwright {

class RandomAgent final : public Agent {
 public:
  std::string name() const override { return "random"; }
  std::vector<Action> Act(std::span<const TaskView> views,
                          std::span<RandomStream> streams) override;
};

}  // namespace sandwright
