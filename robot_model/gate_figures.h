// What one way of moving the arm comes to, and the limits that it is held to.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "robot_model/ur10.h"
#include "robot_model/workcell.h"

namespace sandwright {

// A cell's limits with the margins that apply. `rates` divides speeds, accelerations and jerk.
struct GateLimits {
  GateLimits(const MotionLimits& limits, double extra_clearance_m, double extra_singular,
             double extra_position_rad, double rates);

  double clearance_m, singular_value;
  double acceleration, jerk;             // of any joint [rad/s^2], [rad/s^3]
  Vector6 position, rated_speed, speed;  // a joint [rad], [rad/s]
};

struct ArmFigures {
  // Distances are measured up to `seen_m`.
  explicit ArmFigures(double seen_m) : min_clearance_m(seen_m) {}

  std::vector<std::string> reasons;  // each with figure and limit; empty: nothing against it
  double peak_speed_share = 0;       // of the joints' rated speed, 0..1
  double min_clearance_m;
  double min_singular_value = std::numeric_limits<double>::infinity();
  double duration_s = 0;
};

// The worst of each joint quantity so far, and the reasons that follow from it and from nearness to
// a singularity.
struct JointPeaks {
  static void Raise(Vector6& peak, const Vector6& value) { peak = peak.cwiseMax(value.cwiseAbs()); }
  void Report(const GateLimits& limits, ArmFigures& figures) const;

  Vector6 position = Vector6::Zero(), speed = Vector6::Zero(), acceleration = Vector6::Zero(),
          jerk = Vector6::Zero();
};

}  // namespace sandwright
