#include "tests/support/controller_fake/fake_arm.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace sandwright::fake {
namespace {

constexpr int kNewtonSteps = 20;
constexpr double kReached = 1e-10;             // m and rad, of an inverse
constexpr double kLongestNewtonStep_rad = 0.3;
constexpr double kStopBefore_radps2 = 8;       // of a movement in the way of the next
constexpr double kDampingSquared = 1e-8;       // of the Jacobian's inverse
constexpr double kLargestServoAcceleration_radps2 = 15;

// Twist that moves `from` to `to`.
Vector6 Error(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
  Vector6 error;
  error << to.translation() - from.translation(),
      RotationVector(to.linear() * from.linear().transpose());
  return error;
}

Vector6 SolveDamped(const Matrix6& J, const Vector6& twist) {
  const Matrix6 square = J * J.transpose() + kDampingSquared * Matrix6::Identity();
  return J.transpose() * square.partialPivLu().solve(twist);
}

}  // namespace

FakeArm::FakeArm(const DhParameters& dh, const JointAngles& start)
    : kinematics_(dh), q_(start), q_begin_(start) {}

void FakeArm::SetTcp(const Eigen::Isometry3d& X_FT) { X_FT_ = X_FT; }

std::optional<JointAngles> FakeArm::Inverse(const Eigen::Isometry3d& X_WT,
                                            const JointAngles& near) const {
  const Eigen::Isometry3d X_WF = X_WT * X_FT_.inverse();
  JointAngles q = near;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const Vector6 error = Error(kinematics_.Forward(q), X_WF);
    if (error.norm() < kReached) return q;
    Vector6 step = SolveDamped(kinematics_.Jacobian(q), error);
    const double longest = step.lpNorm<Eigen::Infinity>();
    if (longest > kLongestNewtonStep_rad) step *= kLongestNewtonStep_rad / longest;
    q.rad += step;
  }
  std::optional<JointAngles> nearest;
  for (const IkSolution& solution : kinematics_.Inverse(X_WF, near[5])) {
    const JointAngles turned = NearestTurns(solution.q, near);
    if (!nearest || (turned.rad - near.rad).norm() < (nearest->rad - near.rad).norm())
      nearest = turned;
  }
  return nearest;
}

bool FakeArm::MoveDone() const {
  return !pending_ && (drive_ != Drive::kPath || path_time_s_ >= profile_.duration_s());
}

bool FakeArm::CanRoundCorner(const MoveCommand& next) const {
  return drive_ == Drive::kPath && MoveDone() && profile_.end_speed() > 0 && blend_m_ > 0 &&
         path_->chart().in_space() == next.in_space;
}

void FakeArm::StartMove(const MoveCommand& command) {
  pending_.reset();
  if (CanRoundCorner(command)) {
    const double speed = profile_.end_speed();
    path_ = RoundCorner(command);
    Plan(command, speed);
    AdvancePath(std::exchange(spare_s_, 0));
    return;
  }
  if (drive_ != Drive::kStill && qd_.norm() > 1e-6) {
    if (drive_ != Drive::kPath || !MoveDone() || profile_.end_speed() > 0) {
      Stop(kStopBefore_radps2);
      pending_ = command;
      return;
    }
  }
  if (command.in_space) {
    const Eigen::Isometry3d X = TcpPose();
    const Chart chart = Chart::Space(X.linear());
    path_.emplace(chart, chart.Coordinates(X), chart.Coordinates(command.X_WT));
  } else {
    path_.emplace(Chart::Joints(), q_.rad, command.q.rad);
  }
  Plan(command, 0);
}

ArmPath FakeArm::RoundCorner(const MoveCommand& next) const {
  const Vector6& end = path_->end();
  if (!next.in_space) {
    const ArmPath line(Chart::Joints(), end, next.q.rad);
    return {Chart::Joints(), q_.rad, end, BlendLength(line, false, blend_m_), next.q.rad};
  }
  const Eigen::Isometry3d corner = path_->chart().Pose(end);
  const Chart chart = Chart::Space(corner.linear());
  const ArmPath line(chart, chart.Coordinates(corner), chart.Coordinates(next.X_WT));
  return {chart, chart.Coordinates(TcpPose()), chart.Coordinates(corner),
          BlendLength(line, false, blend_m_), chart.Coordinates(next.X_WT)};
}

double FakeArm::BlendLength(const ArmPath& line, bool at_end, double blend_m) const {
  const double most = line.length() / 2;  // two blends never overlap
  if (line.chart().in_space()) return std::min(blend_m, most);
  const auto position = [&](double length) {
    const JointAngles q{line.At(at_end ? line.length() - length : length)};
    return (kinematics_.Forward(q) * X_FT_).translation();
  };
  const Eigen::Vector3d corner = position(0);
  double inside = 0, outside = most;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (inside + outside);
    ((position(middle) - corner).norm() < blend_m ? inside : outside) = middle;
  }
  return inside;
}

void FakeArm::Plan(const MoveCommand& command, double begin_speed) {
  drive_ = Drive::kPath;
  path_time_s_ = profile_from_ = 0;
  const double length = path_->length();
  double speed = std::max(command.speed, 1e-6), acceleration = std::max(command.acceleration, 1e-6);
  if (!command.in_space) {
    acceleration = std::min(acceleration, kJointAccelerationLimit_radps2);
    const Vector6 way = (path_->end() - q_.rad).cwiseAbs();
    for (int i = 0; i < 6 && length > 0; ++i) {
      if (way[i] > 1e-9) speed = std::min(speed, kJointSpeedLimit_radps[i] * length / way[i]);
    }
  }
  acceleration_ = acceleration;
  if (command.duration_s > 0) {
    blend_m_ = 0;
    profile_ = SpeedProfile::InTime(length, command.duration_s);
    return;
  }
  blend_m_ = command.blend_m;
  const double blend = blend_m_ > 0 ? BlendLength(*path_, true, blend_m_) : 0;
  profile_ = SpeedProfile(length - blend, begin_speed, speed, blend > 0 ? speed : 0, acceleration);
}

std::optional<JointAngles> FakeArm::Joints(const ArmPath& path, double length) const {
  const Vector6 at = path.At(length);
  if (!path.chart().in_space()) return JointAngles{at};
  return Inverse(path.chart().Pose(at), q_);
}

// By how much the fastest joint exceeds its limit where the period ends at `q`.
double FakeArm::OverSpeed(const JointAngles& q) const {
  double over = 0;
  for (int i = 0; i < 6; ++i)
    over = std::max(over, std::abs(q[i] - q_begin_[i]) /
                              (kJointSpeedLimit_radps[i] * kControlPeriod_s));
  return over;
}

void FakeArm::AdvancePath(double time_s) {
  constexpr int kTries = 12;
  for (int i = 0; i < kTries; ++i) {
    const auto q = Joints(*path_, profile_from_ + profile_.At(path_time_s_ + time_s));
    if (!q) {
      fault_ = "the straight line leads out of the arm's reach or into a singularity";
      return Stop(kJointAccelerationLimit_radps2);
    }
    if (const double over = OverSpeed(*q); over > 1) {
      time_s /= over * 1.001;
      continue;
    }
    path_time_s_ += time_s;
    spare_s_ = std::max(path_time_s_ - profile_.duration_s(), 0.0);
    path_time_s_ -= spare_s_;
    q_ = *q;
    return;
  }
}

void FakeArm::StartSpeed(const Vector6& qd_radps, double acceleration_radps2) {
  pending_.reset();
  drive_ = Drive::kSpeed;
  wanted_ = qd_radps;
  acceleration_ = std::clamp(acceleration_radps2, 1e-6, kJointAccelerationLimit_radps2);
  speed_reached_ = false;
}

void FakeArm::StartTwist(const Vector6& twist, double acceleration_mps2) {
  StartSpeed(twist, acceleration_mps2);
  drive_ = Drive::kTwist;
}

void FakeArm::Servo(const JointAngles& target, double lookahead_s) {
  pending_.reset();
  drive_ = Drive::kServo;
  servo_target_ = target;
  lookahead_s_ = std::max(lookahead_s, kControlPeriod_s);
}

void FakeArm::Stop(double acceleration_radps2) {
  pending_.reset();
  if (drive_ == Drive::kStill) return;
  drive_ = Drive::kStop;
  acceleration_ = std::clamp(acceleration_radps2, 1e-6, kJointAccelerationLimit_radps2);
}

Vector6 FakeArm::TwistToJoints(const Vector6& twist) {
  const Eigen::Vector3d lever =
      kinematics_.Forward(q_).linear() * X_FT_.translation();  // F to T, in W
  Vector6 flange = twist;
  flange.head<3>() -= twist.tail<3>().cross(lever);
  return SolveDamped(kinematics_.Jacobian(q_), flange);
}

void FakeArm::AdvanceSpeed(const Vector6& wanted, double acceleration, double time_s) {
  Vector6 goal = wanted;
  for (int i = 0; i < 6; ++i)
    goal[i] = std::clamp(goal[i], -kJointSpeedLimit_radps[i], kJointSpeedLimit_radps[i]);
  Vector6 change = goal - qd_;
  const double largest = change.lpNorm<Eigen::Infinity>(), most = acceleration * time_s;
  if (largest > most) change *= most / largest;
  speed_reached_ = largest <= most;
  q_.rad += (qd_ + change) * time_s;
}

void FakeArm::BeginPeriod(double scale) {
  q_begin_ = q_;
  scale_ = scale;
  spare_s_ = 0;
  switch (drive_) {
    case Drive::kStill: break;
    case Drive::kPath: AdvancePath(scale * kControlPeriod_s); break;
    case Drive::kSpeed: AdvanceSpeed(scale * wanted_, acceleration_, kControlPeriod_s); break;
    case Drive::kTwist:
      // An acceleration in m/s^2 is about one in rad/s^2 at an arm's length.
      AdvanceSpeed(scale * TwistToJoints(wanted_), acceleration_, kControlPeriod_s);
      break;
    case Drive::kServo: {
      const Vector6 error = servo_target_.rad - q_.rad;
      Vector6 speed;
      for (int i = 0; i < 6; ++i) {
        const double way = std::abs(error[i]);
        speed[i] = std::copysign(
            std::min(way / lookahead_s_, std::sqrt(2 * kLargestServoAcceleration_radps2 * way)),
            error[i]);
      }
      AdvanceSpeed(scale * speed, kLargestServoAcceleration_radps2, kControlPeriod_s);
      break;
    }
    case Drive::kStop:
      AdvanceSpeed(Vector6::Zero(), acceleration_, kControlPeriod_s);
      if (!speed_reached_) break;
      drive_ = Drive::kStill;
      if (pending_) {
        qd_.setZero();
        StartMove(*std::exchange(pending_, std::nullopt));
      }
      break;
  }
  qd_ = (q_.rad - q_begin_.rad) / kControlPeriod_s;
}

void FakeArm::EndPeriod() {
  if (drive_ == Drive::kPath && MoveDone()) {
    if (const double speed = profile_.end_speed(); speed > 0) {
      // Nothing took over: the corner is where the arm stops.
      profile_from_ = path_->length() - BlendLength(*path_, true, blend_m_);
      profile_ =
          SpeedProfile(path_->length() - profile_from_, speed, speed, 0, acceleration_);
      path_time_s_ = blend_m_ = 0;
    } else {
      drive_ = Drive::kStill;
    }
  }
  qd_ = (q_.rad - q_begin_.rad) / kControlPeriod_s;
}

}  // namespace sandwright::fake
