#include "env/reward.h"

#include <cmath>

#include "data/task.h"

namespace sandwright {

Reward StrokeReward(const RewardConfig& config, const HeightMap& before, const HeightMap& after,
                    const HeightMap& goal) {
  SAND_CHECK(before.SameGrid(after) && before.SameGrid(goal), before.rows, after.rows, goal.rows);
  double outside_m = 0;  // sum of |change| where the goal does not count
  for (size_t i = 0; i < goal.size(); ++i) {
    if (!goal.mask[i])
      outside_m += std::abs(static_cast<double>(after.height_m[i]) - before.height_m[i]);
  }
  const double outside_cm3 = outside_m * before.cell_size_m * before.cell_size_m * 1e6;
  Reward reward;
  reward.progress = config.per_mm * (GoalError(before, goal) - GoalError(after, goal)) * 1e3;
  reward.stroke = -config.stroke_cost;
  reward.outside = -config.outside_cost_per_cm3 * outside_cm3;
  return reward;
}

Reward RejectedReward(const RewardConfig& config) {
  Reward reward;
  reward.stroke = -config.stroke_cost;
  reward.rejected = -config.rejected_cost;
  return reward;
}

}  // namespace sandwright
