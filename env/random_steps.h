// Random actions through a shaping environment, and what must never happen there.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>

#include "env/shaping_env.h"

namespace sandwright {

struct RandomStepTally {
  int64_t steps = 0, rejected = 0, episodes = 0;
  int64_t not_finite = 0;     // numbers of observations and rewards
  int64_t out_of_bounds = 0;  // numbers of observations beyond ObservationSpec's
  // Largest difference over an episode between the rewards for progress and the drop of the goal
  // error [mm], with RewardConfig::per_mm = 1.
  double potential_mm = 0;

  bool sound() const { return not_finite == 0 && out_of_bounds == 0 && potential_mm < 1e-6; }
  nlohmann::json ToJson() const;
};

// At least `steps` steps of all rows of an environment that starts anew in the same step and is not in a
// random phase.
RandomStepTally RunRandomSteps(ShapingEnv& env, int64_t steps, uint64_t seed);

}  // namespace sandwright
