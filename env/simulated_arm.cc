#include "env/simulated_arm.h"

#include <algorithm>
#include <cmath>

namespace sandwright {
namespace {

constexpr double kSettleLags = 8;  // e^-8 of the lag is left

}  // namespace

SimulatedArm::SimulatedArm(const Workcell& workcell, const SimulatedArmConfig& config)
    : config_(config),
      X_BW_(workcell.X_WB.ToIsometry().inverse()),
      model_(MakeArmModel(workcell)),
      data_(MakeArmData(*model_)) {}

ArmRecord SimulatedArm::Follow(const std::vector<JointAngles>& knots, RandomStream& random,
                               double speed_share) const {
  constexpr double dt = StrokeMotion::kPeriod_s;
  // Exact discrete forms of the first-order lag and of the Ornstein-Uhlenbeck error.
  const double follow = config_.servo_lag_s > 0 ? 1 - std::exp(-dt / config_.servo_lag_s) : 1;
  const double keep = std::exp(-dt / config_.wander_time_s), stir = std::sqrt(1 - keep * keep);
  const auto settle = static_cast<size_t>(std::ceil(kSettleLags * config_.servo_lag_s / dt));
  const double last = static_cast<double>(knots.size() - 1);
  const auto periods = static_cast<size_t>(std::ceil(last / speed_share)) + 1;
  Vector6 servo = knots.front().rad, error, before;
  for (double& e : error) e = config_.wander_rad * random.Normal();
  before = servo + error;
  ArmRecord record;
  for (size_t i = 0; i < periods + settle; ++i) {
    const double at = std::min(last, static_cast<double>(i) * speed_share);
    const auto knot = static_cast<size_t>(at);
    const JointAngles &a = knots[knot], &b = knots[std::min(knot + 1, knots.size() - 1)];
    const JointAngles command{a.rad + (at - static_cast<double>(knot)) * (b.rad - a.rad)};
    servo += follow * (command.rad - servo);
    for (double& e : error) e = keep * e + stir * config_.wander_rad * random.Normal();
    record.time_s.push_back(static_cast<double>(i) * dt);
    record.commanded.push_back(command);
    record.measured.push_back({servo + error});
    record.speed_radps.push_back((record.measured.back().rad - before) / dt);
    before = record.measured.back().rad;
  }
  return record;
}

Eigen::Isometry3d SimulatedArm::BladeInBox(const JointAngles& q) const {
  SetJoints(*model_, q, *data_);
  return X_BW_ * SitePose(*model_, *data_, "T");
}

}  // namespace sandwright
