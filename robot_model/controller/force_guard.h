// Contact that a stroke must not make: the box, the floor, a stone.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "robot_model/workcell.h"

namespace sandwright {

// Force at the TCP [N] for each knot of a stroke's path, as it was felt in the air in the same
// postures: a CB3 estimates forces from joint currents and cannot be zeroed.
using ForceBaseline = std::vector<Eigen::Vector3d>;

struct ForceSample {
  size_t knot = 0;  // of the whole motion
  Eigen::Vector3d force_n;
};

// The baseline out of a lifted pass: for each knot in [path_begin, path_end) the mean over 0.2 s,
// as one sample alone has a standard deviation of some 4 N. Empty where none lies on the path.
ForceBaseline MakeForceBaseline(std::span<const ForceSample> lifted, size_t path_begin,
                                size_t path_end);

// Trips where |F - F0| stays above its limit for kSamples consecutive samples, and stays tripped.
//
// From the knot `stroke_begin` on F0 is the baseline of the nearest path knot (entry and exit are
// in almost the posture of the path's ends) and the limit is contact_force_n. Before it, and where
// there is no baseline, F0 is zero and the limit is the pendant's force limit less its tolerance:
// crude, since the arm's own error of estimation counts as contact.
class ForceGuard {
 public:
  static constexpr int kSamples = 3;  // 24 ms

  // `path_begin`: the motion's knot to which baseline.front() belongs.
  ForceGuard(const MotionLimits& limits, ForceBaseline baseline, size_t stroke_begin,
             size_t path_begin);

  void Take(const ForceSample& sample);
  bool tripped() const { return tripped_; }
  double contact_n() const { return contact_n_; }  // |F - F0| of the last sample
  double limit_n() const { return limit_n_; }      // the one that was applied to it

 private:
  MotionLimits limits_;
  ForceBaseline baseline_;
  size_t stroke_begin_, path_begin_;
  double contact_n_ = 0, limit_n_ = 0;
  int above_ = 0;
  bool tripped_ = false;
};

}  // namespace sandwright
