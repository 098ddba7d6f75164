#include "robot_model/curve_speed.h"

#include <algorithm>
#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr int kPoints = 400;

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// c0 + c1 t + c2 t^2 + c3 t^3 in the plane; c0 does not matter here.
struct PlaneCurve {
  explicit PlaneCurve(const std::vector<Eigen::Vector3d>& points) {
    const auto p = [&](size_t i) { return Eigen::Vector2d(points[i].head<2>()); };
    if (points.size() == 3) {
      c1 = 2 * (p(1) - p(0)), c2 = p(2) - 2 * p(1) + p(0), c3.setZero();
    } else {
      c1 = 3 * (p(1) - p(0)), c2 = 3 * (p(2) - 2 * p(1) + p(0)),
      c3 = p(3) - 3 * p(2) + 3 * p(1) - p(0);
    }
  }
  Eigen::Vector2d c1, c2, c3;
};

}  // namespace

double MetresPerRadian(const Stroke& stroke, const MotionSettings& settings) {
  return std::max(stroke.speed_mps / settings.turn_speed_radps,
                  settings.path_acceleration_mps2 / settings.turn_acceleration_radps2);
}

double CurveSpeed(const Stroke& stroke, const MotionSettings& settings) {
  SAND_CHECK(stroke.degree == 2 && stroke.control_points_m.size() >= 3, stroke.degree);
  const PlaneCurve curve(stroke.control_points_m);
  const double scale = MetresPerRadian(stroke, settings);
  double second_peak = 1e-9, third_peak = 1e-9, second_before = 0;
  for (int k = 0; k <= kPoints; ++k) {
    const double t = static_cast<double>(k) / kPoints;
    const Eigen::Vector2d d1 = curve.c1 + t * (2 * curve.c2 + 3 * t * curve.c3);
    const Eigen::Vector2d d2 = 2 * curve.c2 + 6 * t * curve.c3, d3 = 6 * curve.c3;
    const double speed2 = std::max(d1.squaredNorm(), 1e-18), speed = std::sqrt(speed2);
    const double bend =
        Cross(d1, d2) / (speed2 * speed);  // curvature, and its derivative by length:
    const double bend_s =
        (Cross(d1, d3) / (speed2 * speed) - 3 * bend * d1.dot(d2) / speed2) / speed;
    const double stretch2 = 1 + scale * scale * bend * bend;  // (d sigma / ds)^2
    // yaw' = bend / sqrt(stretch2) by sigma; differentiated once more:
    const double second = bend_s / (stretch2 * stretch2);
    second_peak = std::max(second_peak, std::abs(second));
    if (k > 0)
      third_peak = std::max(
          third_peak, std::abs(second - second_before) * kPoints / (speed * std::sqrt(stretch2)));
    second_before = second;
  }
  const double acceleration = settings.turn_acceleration_radps2,
               jerk = acceleration / settings.smoothing_s;
  return std::min(
      {stroke.speed_mps, std::sqrt(acceleration / second_peak), std::cbrt(jerk / third_peak)});
}

}  // namespace sandwright
