// How far along its planned motion an arm is.
#pragma once

#include <vector>

#include "robot_model/ur10.h"

namespace sandwright {

// The nearest planned knot, searched forward from the last one. The plan's timing is not used: the
// speed slider, pauses and the controller's own acceleration stretch it.
class MotionProgress {
 public:
  // A frame can move the arm by one knot; this allows for lost frames and for a controller that
  // accelerates harder than the plan, and is too little to jump to a path's way back.
  static constexpr size_t kKnotsAhead = 16;

  explicit MotionProgress(std::vector<JointAngles> knots);

  void Take(const JointAngles& q);
  size_t knot() const { return knot_; }
  // Largest difference of a joint from that knot [rad].
  double deviation_rad() const { return deviation_rad_; }
  double DistanceFromEnd_rad(const JointAngles& q) const;

 private:
  std::vector<JointAngles> knots_;
  size_t knot_ = 0;
  double deviation_rad_ = 0;
};

}  // namespace sandwright
