// Where a movement leads: a line through joint space or through space, entered by a rounded corner
// where it follows another movement without a stop; and how fast it is travelled.
#pragma once

#include <array>

#include "tests/support/controller_fake/controller_state.h"

namespace sandwright::fake {

// Six numbers that a path is straight in: joint angles, or a position [m] with the rotation vector
// [rad] of the orientation seen from a fixed one.
class Chart {
 public:
  static Chart Joints() { return Chart(false, Eigen::Matrix3d::Identity()); }
  static Chart Space(const Eigen::Matrix3d& orientation) { return Chart(true, orientation); }

  bool in_space() const { return in_space_; }
  Vector6 Coordinates(const Eigen::Isometry3d& X) const;
  Eigen::Isometry3d Pose(const Vector6& coordinates) const;
  // Metres of a step in space (radians where it only turns), radians of the joint that moves most.
  double Length(const Vector6& step) const;

 private:
  Chart(bool in_space, Eigen::Matrix3d orientation)
      : in_space_(in_space), orientation_(std::move(orientation)) {}

  bool in_space_;
  Eigen::Matrix3d orientation_;
};

class ArmPath {
 public:
  ArmPath(Chart chart, const Vector6& from, const Vector6& to);
  // From `entry` round `corner` on to the line from `corner` to `to`, which is met `radius` (in the
  // chart's length) behind the corner.
  ArmPath(Chart chart, const Vector6& entry, const Vector6& corner, double radius,
          const Vector6& to);

  const Chart& chart() const { return chart_; }
  double length() const { return bend_length_ + line_length_; }
  const Vector6& end() const { return to_; }
  Vector6 At(double length) const;

 private:
  static constexpr int kBendSteps = 32;

  Vector6 Bend(double t) const;

  Chart chart_;
  Vector6 entry_, corner_, from_, to_;  // bend: entry, corner, from; then the line from, to
  std::array<double, kBendSteps + 1> bend_at_{};
  double bend_length_ = 0, line_length_ = 0;
};

// Trapezoid of speed along a path, from a speed to a speed.
class SpeedProfile {
 public:
  // Brakes harder than `acceleration` only where the path is too short for the speed it begins
  // with. An end speed that cannot be reached becomes the one that can.
  SpeedProfile(double length, double begin, double peak, double end, double acceleration);
  // From rest to rest in a time.
  static SpeedProfile InTime(double length, double duration_s);

  double duration_s() const { return t1_ + t2_ + t3_; }
  double At(double t_s) const;
  double Speed(double t_s) const;
  double end_speed() const { return end_; }

 private:
  double length_, begin_, peak_, end_;
  double t1_ = 0, t2_ = 0, t3_ = 0;
};

}  // namespace sandwright::fake
