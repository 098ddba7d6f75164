// The arm itself: joint angles over time, within the joints' speeds, for the movements of URScript.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "tests/support/controller_fake/arm_path.h"

namespace sandwright::fake {

inline constexpr double kJointSpeedLimit_radps[6] = {2.0944, 2.0944, 3.1416,
                                                     3.1416, 3.1416, 3.1416};
// What the fake's motors give at most; the maker does not publish a figure.
inline constexpr double kJointAccelerationLimit_radps2 = 40;

struct MoveCommand {
  bool in_space = false;  // straight in space, otherwise straight in the joints
  JointAngles q;          // target of a move in the joints
  Eigen::Isometry3d X_WT = Eigen::Isometry3d::Identity();  // target of a move in space
  double acceleration = 1.2;                               // m/s^2 or rad/s^2
  double speed = 0.25;                                     // m/s or rad/s
  double duration_s = 0;  // over 0: from rest to rest in that time, whatever the speed
  double blend_m = 0;
};

class FakeArm {
 public:
  FakeArm(const DhParameters& dh, const JointAngles& start);

  const Ur10& kinematics() const { return kinematics_; }
  const JointAngles& q() const { return q_; }
  const Vector6& qd_radps() const { return qd_; }
  void SetTcp(const Eigen::Isometry3d& X_FT);
  const Eigen::Isometry3d& tcp() const { return X_FT_; }
  Eigen::Isometry3d TcpPose() const { return kinematics_.Forward(q_) * X_FT_; }
  // Joint angles of a TCP pose, those nearest to `near`; none where it is out of reach.
  std::optional<JointAngles> Inverse(const Eigen::Isometry3d& X_WT, const JointAngles& near) const;

  // Begins a movement, rounding the corner where the last one is still moving towards it.
  void StartMove(const MoveCommand& command);
  // At rest on its target, or arrived where the next movement may take over.
  bool MoveDone() const;
  // Joint speeds to be reached and held until the next command.
  void StartSpeed(const Vector6& qd_radps, double acceleration_radps2);
  // The same for a twist of the TCP (m/s, rad/s).
  void StartTwist(const Vector6& twist, double acceleration_mps2);
  bool SpeedReached() const { return drive_ == Drive::kSpeed && speed_reached_; }
  // Follows a joint target that changes from period to period.
  void Servo(const JointAngles& target, double lookahead_s);
  // Puts an arm that is at rest elsewhere.
  void Place(const JointAngles& q) {
    if (AtRest()) q_ = q_begin_ = q;
  }
  // Slows all joints down together.
  void Stop(double acceleration_radps2);
  bool AtRest() const { return drive_ == Drive::kStill; }
  // Moving on its own, so that nothing but a command or a stop ends it.
  bool OnPath() const { return drive_ == Drive::kPath; }
  bool Driven() const { return drive_ != Drive::kStill && drive_ != Drive::kStop; }

  // One control period is a BeginPeriod, any number of commands, and an EndPeriod. `scale`: how
  // much of the time passes for the movement, 0..1 (speed slider, pauses, stops).
  void BeginPeriod(double scale);
  void EndPeriod();
  // Why the arm cannot go on (a singularity, out of reach); taken by the caller.
  std::optional<std::string> TakeFault() { return std::exchange(fault_, std::nullopt); }

 private:
  enum class Drive { kStill, kPath, kSpeed, kTwist, kServo, kStop };

  void AdvancePath(double time_s);
  void AdvanceSpeed(const Vector6& wanted, double acceleration, double time_s);
  Vector6 TwistToJoints(const Vector6& twist);
  std::optional<JointAngles> Joints(const ArmPath& path, double length) const;
  double OverSpeed(const JointAngles& q) const;
  bool CanRoundCorner(const MoveCommand& next) const;
  ArmPath RoundCorner(const MoveCommand& next) const;
  void Plan(const MoveCommand& command, double begin_speed);
  // How far from the corner [path length] the TCP is `blend_m` away from it.
  double BlendLength(const ArmPath& line, bool at_end, double blend_m) const;

  Ur10 kinematics_;
  Eigen::Isometry3d X_FT_ = Eigen::Isometry3d::Identity();
  JointAngles q_, q_begin_;  // now, and at the beginning of the period
  Vector6 qd_ = Vector6::Zero();

  Drive drive_ = Drive::kStill;
  std::optional<ArmPath> path_;
  SpeedProfile profile_{0, 0, 0, 0, 1};
  double profile_from_ = 0;  // length of path at which the profile begins
  double path_time_s_ = 0;   // on the profile
  double blend_m_ = 0;
  double scale_ = 1, spare_s_ = 0;  // spare: of the period, behind the end of the last path
  std::optional<MoveCommand> pending_;  // waits until the arm has stopped

  Vector6 wanted_ = Vector6::Zero();  // speed or twist
  double acceleration_ = 1;
  bool speed_reached_ = false;
  JointAngles servo_target_;
  double lookahead_s_ = 0.1;
  std::optional<std::string> fault_;
};

}  // namespace sandwright::fake
