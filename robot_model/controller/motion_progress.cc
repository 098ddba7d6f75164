#include "robot_model/controller/motion_progress.h"

#include <algorithm>

#include "data/base/error.h"

namespace sandwright {
namespace {

double Distance(const JointAngles& a, const JointAngles& b) {
  return (a.rad - b.rad).cwiseAbs().maxCoeff();
}

}  // namespace

MotionProgress::MotionProgress(std::vector<JointAngles> knots) : knots_(std::move(knots)) {
  SAND_CHECK(!knots_.empty());
}

void MotionProgress::Take(const JointAngles& q) {
  const size_t last = std::min(knot_ + kKnotsAhead, knots_.size() - 1);
  deviation_rad_ = Distance(q, knots_[knot_]);
  for (size_t i = knot_ + 1; i <= last; ++i) {
    const double distance = Distance(q, knots_[i]);
    if (distance >= deviation_rad_) continue;
    deviation_rad_ = distance;
    knot_ = i;
  }
}

double MotionProgress::DistanceFromEnd_rad(const JointAngles& q) const {
  return Distance(q, knots_.back());
}

}  // namespace sandwright
