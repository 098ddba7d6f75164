// How fast a curved stroke may be travelled, so that the turning of the blade stays smooth.
#pragma once

#include "data/stroke.h"
#include "robot_model/workcell.h"

namespace sandwright {

// Metres that a radian of turning counts for in a curve's parameter sigma, where
// d(sigma)^2 = ds^2 + (metres_per_rad d(yaw))^2: at a constant rate of sigma, speed and turning
// both stay within the stroke's speed and the settings. (In quadrature, not as a sum, to stay
// smooth where the curve changes its sense of turning.)
double MetresPerRadian(const Stroke& stroke, const MotionSettings& settings);

// The rate of sigma [m/s], at most the stroke's speed, at which the yaw keeps to the settings'
// turning acceleration and, through smoothing_s, jerk: its second derivative grows with the square
// of the rate, the third with the cube. From the curve's curvature in closed form at 400 points.
double CurveSpeed(const Stroke& stroke, const MotionSettings& settings);

}  // namespace sandwright
