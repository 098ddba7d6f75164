// Optimal transport of sand from where it lies above the goal to where it is missing.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "env/agent.h"

namespace sandwright {

// Sand to bring from one bin, the middle of its cells in frame B, to another.
struct SandFlow {
  Eigen::Vector2d from_m, to_m;
  double volume_m3 = 0;
};

// The flows with the least sum of volume times distance that bring the whole surplus into the deficit,
// or fill the whole deficit, whichever is the smaller (earth mover's distance; Rubner et al., IJCV
// 2000). What is above the goal in a bin makes up for what is
// missing in it. Bins are squares of `bin_m` over the region, larger ones where more than 24 would lie in a row.
std::vector<SandFlow> OptimalTransport(const TaskView& view, double bin_m);

}  // namespace sandwright
