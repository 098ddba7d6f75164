#include "robot_model/gate_figures.h"

#include <spdlog/fmt/fmt.h>

namespace sandwright {

GateLimits::GateLimits(const MotionLimits& limits, double extra_clearance_m, double extra_singular,
                       double extra_position_rad, double rates)
    : clearance_m(limits.clearance_m + extra_clearance_m),
      singular_value(limits.min_singular_value + extra_singular),
      acceleration(limits.joint_acceleration_radps2 * limits.share_of_acceleration / rates),
      jerk(limits.joint_jerk_radps3 * limits.share_of_acceleration / rates) {
  for (size_t i = 0; i < 6; ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    position[joint] =
        limits.joint_position_rad[i] - limits.position_margin_rad - extra_position_rad;
    rated_speed[joint] = limits.joint_speed_radps[i];
    speed[joint] = limits.joint_speed_radps[i] * limits.share_of_speed / rates;
  }
}

void JointPeaks::Report(const GateLimits& limits, ArmFigures& figures) const {
  figures.peak_speed_share = (speed.cwiseQuotient(limits.rated_speed)).maxCoeff();
  for (int i = 0; i < 6; ++i) {
    const auto over = [&](const char* what, double value, double limit, const char* unit) {
      if (!(value <= limit))
        figures.reasons.push_back(
            fmt::format("joint {} {} {:.3f} {}; limit {:.3f}", i + 1, what, value, unit, limit));
    };
    over("position", position[i], limits.position[i], "rad");
    over("speed", speed[i], limits.speed[i], "rad/s");
    over("acceleration", acceleration[i], limits.acceleration, "rad/s^2");
    over("jerk", jerk[i], limits.jerk, "rad/s^3");
  }
  if (figures.min_singular_value < limits.singular_value)
    figures.reasons.push_back(
        fmt::format("near a singularity: smallest singular value {:.4f}; needs {:.4f}",
                    figures.min_singular_value, limits.singular_value));
}

}  // namespace sandwright
