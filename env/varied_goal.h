// Training sets around one goal: it moved, turned, deeper or shallower, on varied sand.
#pragma once

#include "data/base/config.h"
#include "data/base/random.h"
#include "data/task.h"

namespace sandwright {

struct VaryConfig {
  double shift_m = 0.05;
  double turn_deg = 180;
  double depth_low = 0.7, depth_high = 1.3;
  double amplitude_m = 0.006;
  double hill_m = 0.1;

  void Fields(FieldList& f) {
    f.Add("shift_m", shift_m, "the goal moves by up to this along x and along y [m]", 0, 5);
    f.Add("turn_deg", turn_deg, "and turns by up to this, either way [deg]", 0, 180);
    f.Add("depth_low", depth_low, "least factor of its heights and depths [1]", 0.05, 5);
    f.Add("depth_high", depth_high, "largest factor of its heights and depths [1]", 0.05, 5);
    f.Add("amplitude_m", amplitude_m, "standard deviation of hills added to the terrain [m]", 0, 0.1);
    f.Add("hill_m", hill_m, "size of the largest of them [m]", 0.01, 5);
  }
};

// One task: `terrain` with hills, settled to 33 degrees; `goal` (mask filled) moved and turned about the middle of
// what counts, its heights about their mean scaled, what leaves the box cut off, slopes beyond 33 degrees slid to
// rest, on the level that gives it the new terrain's volume. Error where nothing of it stays in the box.
Task VaryGoal(const HeightMap& terrain, const HeightMap& goal, const VaryConfig& config, int max_strokes,
              RandomStream& stream);

}  // namespace sandwright
