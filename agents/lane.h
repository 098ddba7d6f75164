// A strip of sand as wide as the blade, and the transport of sand along it.
#pragma once

#include <vector>

#include "env/agent.h"

namespace sandwright {

struct Lane {
  Eigen::Vector2d start_m;  // of the middle line, in frame B
  Eigen::Vector2d along;    // unit vector
  double step_m = 0;
  // Height less goal at equal steps [m], mean across the blade; what does not count adds zero.
  std::vector<double> above_m;

  size_t size() const { return above_m.size(); }
  // Middle of step i.
  Eigen::Vector2d At(size_t i) const {
    return start_m + (static_cast<double>(i) + 0.5) * step_m * along;
  }
};

// The sand along the line from `start_m`, `length_m` long; `along` has length 1.
Lane LaneOf(const TaskView& view, const Eigen::Vector2d& start_m, const Eigen::Vector2d& along,
            double length_m, double width_m);

// From step `first`, where sand lies too high, to step `last`, where it is missing.
struct Pass {
  size_t first = 0, last = 0;
  double area_m2 = 0;  // of the lane's section that sand from the pass fills
};

// For each step with too much sand, the pass of at most `longest_m` from there that fills most: what
// lies too high is taken along, and the first hollows ahead are filled with it (optimal transport
// where sand only goes ahead). The shortest of equals.
std::vector<Pass> PassesOf(const Lane& lane, double longest_m);

}  // namespace sandwright
