// What a stroke is worth.
#pragma once

#include "data/base/config.h"
#include "data/height_map.h"

namespace sandwright {

struct RewardConfig {
  double per_mm = 1;
  double stroke_cost = 0.02;
  double outside_cost_per_cm3 = 0.001;
  double rejected_cost = 0.1;

  void Fields(FieldList& f) {
    f.Add("per_mm", per_mm, "reward for each mm that the goal error drops [1/mm]", 0, 1000);
    f.Add("stroke_cost", stroke_cost, "cost of every stroke, rejected ones too", 0, 100);
    f.Add("outside_cost_per_cm3", outside_cost_per_cm3,
          "cost of sand added or taken where the goal does not count [1/cm^3]", 0, 100);
    f.Add("rejected_cost", rejected_cost, "further cost of a stroke that the gate rejects", 0, 100);
  }
};

// The terms of one stroke's reward, signed: costs are negative.
struct Reward {
  // Drop of the goal error: potential-based and undiscounted, so over an episode it adds up to the
  // whole drop whatever the way there.
  double progress = 0;
  double stroke = 0;
  double outside = 0;
  double rejected = 0;
  double total() const { return progress + stroke + outside + rejected; }
};

// Reward of an executed stroke between two true maps of the goal's grid.
Reward StrokeReward(const RewardConfig& config, const HeightMap& before, const HeightMap& after,
                    const HeightMap& goal);
// Reward of a stroke that the gate rejected: nothing moved.
Reward RejectedReward(const RewardConfig& config);

}  // namespace sandwright
