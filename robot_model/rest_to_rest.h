// How fast a piece of path is travelled: from rest to rest, with
// bounded speed, acceleration and jerk.
#pragma once

#include <algorithm>
#include <cmath>

#include "data/base/error.h"

namespace sandwright {

// Trapezoid of speed, averaged over a sliding window: the average ramps the
// acceleration up and down, so the jerk is at most 2 acceleration / smoothing_s.
// Lengths in m (or rad, or any path parameter).
class RestToRest {
 public:
  RestToRest(double length, double speed, double acceleration, double smoothing_s)
      : length_(length), acceleration_(acceleration), smoothing_s_(smoothing_s) {
    SAND_CHECK(length >= 0 && speed > 0 && acceleration > 0 && smoothing_s > 0, length, speed,
               acceleration, smoothing_s);
    ramp_s_ = std::min(speed / acceleration, std::sqrt(length / acceleration));
    speed_ = acceleration * ramp_s_;
    cruise_s_ = speed_ > 0 ? length / speed_ - ramp_s_ : 0;
  }

  double duration_s() const { return length_ > 0 ? 2 * ramp_s_ + cruise_s_ + smoothing_s_ : 0; }
  double speed() const { return speed_; }  // the peak

  // Travelled length at time t, held before the start and after the end.
  double At(double t_s) const {
    if (t_s <= 0) return 0;
    if (t_s >= duration_s()) return length_;
    return std::clamp((Integral(t_s) - Integral(t_s - smoothing_s_)) / smoothing_s_, 0.0, length_);
  }

 private:
  // Integral of the unsmoothed length over time from 0 to t.
  double Integral(double t) const {
    const double a = acceleration_, v = speed_, r = ramp_s_, c = std::max(cruise_s_, 0.0);
    if (t <= 0) return 0;
    if (t <= r) return a * t * t * t / 6;
    const double after_ramp = a * r * r * r / 6;
    if (t <= r + c) return after_ramp + v * r * (t - r) / 2 + v * (t - r) * (t - r) / 2;
    const double after_cruise = after_ramp + v * r * c / 2 + v * c * c / 2;
    const double left = std::max(2 * r + c - t, 0.0), braked = std::min(t, 2 * r + c) - r - c;
    const double at_rest = std::max(t - 2 * r - c, 0.0);
    return after_cruise + length_ * (braked + at_rest) - a * (r * r * r - left * left * left) / 6;
  }

  double length_, acceleration_, smoothing_s_;
  double speed_, ramp_s_, cruise_s_;
};

}  // namespace sandwright
