// A stroke as joint motion over time.
#pragma once

#include <array>
#include <vector>

#include "robot_model/ur10.h"

namespace sandwright {

// Knots at a constant period; between them the joints move linearly.
struct StrokeMotion {
  static constexpr double kPeriod_s = 0.008;  // of the CB3 controller, 125 Hz

  std::vector<JointAngles> knots;
  // First knot of the path and one behind its last: before it the blade goes down, behind it up.
  size_t path_begin = 0, path_end = 0;
  Branch branch = 0;

  double duration_s() const {
    return knots.empty() ? 0 : static_cast<double>(knots.size() - 1) * kPeriod_s;
  }
};

}  // namespace sandwright
