#include "env/simulated_arm.h"

#include <cmath>
#include <numbers>

namespace sandwright {
namespace {

constexpr double kPathStep_m = 1e-3, kPathTurn_rad = 0.05;
constexpr double kSettleLags = 8;  // e^-8 of the lag is left

}  // namespace

SimulatedArm::SimulatedArm(const Workcell& workcell, const SimulatedArmConfig& config)
    : config_(config),
      X_BW_(workcell.X_WB.ToIsometry().inverse()),
      model_(MakeArmModel(workcell)) {}

ArmRecord SimulatedArm::Follow(const std::vector<JointAngles>& knots, RandomStream& random) const {
  constexpr double dt = StrokeMotion::kPeriod_s;
  // Exact discrete forms of the first-order lag and of the Ornstein-Uhlenbeck error.
  const double follow = config_.servo_lag_s > 0 ? 1 - std::exp(-dt / config_.servo_lag_s) : 1;
  const double keep = std::exp(-dt / config_.wander_time_s), stir = std::sqrt(1 - keep * keep);
  const auto settle = static_cast<size_t>(std::ceil(kSettleLags * config_.servo_lag_s / dt));
  Vector6 servo = knots.front().rad, error, before;
  for (double& e : error) e = config_.wander_rad * random.Normal();
  before = servo + error;
  ArmRecord record;
  for (size_t i = 0; i < knots.size() + settle; ++i) {
    const JointAngles& command = knots[std::min(i, knots.size() - 1)];
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

ExecutedStroke SimulatedArm::Execute(const StrokeMotion& motion, RandomStream& random) const {
  ExecutedStroke stroke;
  stroke.record = Follow(motion.knots, random);
  const MujocoData data = MakeArmData(*model_);
  const auto add = [&](size_t i, bool last) {
    SetJoints(*model_, stroke.record.measured[i], *data);
    const Eigen::Isometry3d X_BT = X_BW_ * SitePose(*model_, *data, "T");
    const Eigen::Vector3d normal = (motion.flipped ? -1 : 1) * X_BT.linear().col(0);
    BladePose pose{X_BT.translation().x(), X_BT.translation().y(), X_BT.translation().z(),
                   std::atan2(normal.y(), normal.x())};
    if (!stroke.path.empty()) {
      const BladePose& back = stroke.path.back();
      pose.yaw_rad -=
          2 * std::numbers::pi * std::round((pose.yaw_rad - back.yaw_rad) / (2 * std::numbers::pi));
      const bool moved =
          std::hypot(pose.x_m - back.x_m, pose.y_m - back.y_m, pose.z_m - back.z_m) > kPathStep_m;
      if (!last && !moved && std::abs(pose.yaw_rad - back.yaw_rad) < kPathTurn_rad) return;
    }
    stroke.path.push_back(pose);
  };
  for (size_t i = motion.path_begin; i < motion.path_end; ++i) add(i, i + 1 == motion.path_end);
  return stroke;
}

}  // namespace sandwright
