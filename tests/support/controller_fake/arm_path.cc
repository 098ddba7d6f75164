#include "tests/support/controller_fake/arm_path.h"

#include <algorithm>
#include <cmath>

namespace sandwright::fake {
namespace {

constexpr double kTurnOnly_m = 1e-6;  // a step below it is measured by its turn

}  // namespace

Vector6 Chart::Coordinates(const Eigen::Isometry3d& X) const {
  Vector6 coordinates;
  coordinates << X.translation(), RotationVector(orientation_.transpose() * X.linear());
  return coordinates;
}

Eigen::Isometry3d Chart::Pose(const Vector6& coordinates) const {
  Eigen::Isometry3d X = PoseFromVector(coordinates);
  X.linear() = orientation_ * X.linear();
  return X;
}

double Chart::Length(const Vector6& step) const {
  if (!in_space_) return step.lpNorm<Eigen::Infinity>();
  const double way = step.head<3>().norm();
  return way > kTurnOnly_m ? way : step.tail<3>().norm();
}

ArmPath::ArmPath(Chart chart, const Vector6& from, const Vector6& to)
    : chart_(std::move(chart)),
      entry_(from),
      corner_(from),
      from_(from),
      to_(to),
      line_length_(chart_.Length(to - from)) {}

ArmPath::ArmPath(Chart chart, const Vector6& entry, const Vector6& corner, double radius,
                 const Vector6& to)
    : chart_(std::move(chart)), entry_(entry), corner_(corner), from_(corner), to_(to) {
  const double leg = chart_.Length(to - corner);
  if (leg > 0) from_ = corner + std::min(1.0, radius / leg) * (to - corner);
  line_length_ = leg > 0 ? leg * (1 - std::min(1.0, radius / leg)) : 0;
  for (int i = 1; i <= kBendSteps; ++i) {
    const double t0 = static_cast<double>(i - 1) / kBendSteps,
                 t1 = static_cast<double>(i) / kBendSteps;
    bend_at_[i] = bend_at_[i - 1] + chart_.Length(Bend(t1) - Bend(t0));
  }
  bend_length_ = bend_at_.back();
}

// Parabola that leaves the first line and meets the second along them.
Vector6 ArmPath::Bend(double t) const {
  return (1 - t) * (1 - t) * entry_ + 2 * t * (1 - t) * corner_ + t * t * from_;
}

Vector6 ArmPath::At(double length) const {
  if (length < bend_length_) {
    const auto above = std::ranges::upper_bound(bend_at_, std::max(length, 0.0));
    const auto i = std::clamp<ptrdiff_t>(above - bend_at_.begin(), 1, kBendSteps);
    const double step = bend_at_[i] - bend_at_[i - 1];
    const double share = step > 0 ? (length - bend_at_[i - 1]) / step : 0;
    return Bend((static_cast<double>(i - 1) + share) / kBendSteps);
  }
  if (line_length_ <= 0) return to_;
  return from_ + std::min(1.0, (length - bend_length_) / line_length_) * (to_ - from_);
}

SpeedProfile::SpeedProfile(double length, double begin, double peak, double end,
                           double acceleration)
    : length_(length), begin_(begin), peak_(peak), end_(std::min(end, peak)) {
  if (length <= 0) {
    peak_ = end_ = begin_;
    return;
  }
  const double a = acceleration;
  end_ = std::min(end_, std::sqrt(begin * begin + 2 * a * length));
  if (begin <= peak)
    peak_ = std::min(peak, std::sqrt(a * length + 0.5 * (begin * begin + end_ * end_)));
  const double way_in = std::abs(peak_ * peak_ - begin * begin) / (2 * a),
               way_out = std::abs(peak_ * peak_ - end_ * end_) / (2 * a);
  const double cruise = length - way_in - way_out;
  if (cruise < -1e-12 || (begin <= peak && peak_ < std::max(begin, end_))) {
    // Too short for the speed it begins with: one even braking over all of it.
    peak_ = begin;
    t3_ = 2 * length / (begin + end_);
    return;
  }
  t1_ = std::abs(peak_ - begin) / a;
  t2_ = peak_ > 0 ? std::max(cruise, 0.0) / peak_ : 0;
  t3_ = (peak_ - end_) / a;
}

SpeedProfile SpeedProfile::InTime(double length, double duration_s) {
  // A quarter of the time to speed up, a quarter to slow down.
  const double ramp_s = duration_s / 4, speed = length / (duration_s - ramp_s);
  return SpeedProfile(length, 0, speed, 0, speed / ramp_s);
}

double SpeedProfile::At(double t_s) const {
  if (t_s >= duration_s()) return length_;
  if (t_s < t1_) return t_s * (begin_ + 0.5 * (peak_ - begin_) * t_s / t1_);
  const double way_in = 0.5 * (begin_ + peak_) * t1_;
  if (t_s < t1_ + t2_) return way_in + peak_ * (t_s - t1_);
  const double left = duration_s() - t_s;
  return length_ - left * (end_ + 0.5 * (peak_ - end_) * left / t3_);
}

double SpeedProfile::Speed(double t_s) const {
  if (t_s < t1_) return begin_ + (peak_ - begin_) * t_s / t1_;
  if (t_s < t1_ + t2_) return peak_;
  if (t_s < duration_s()) return end_ + (peak_ - end_) * (duration_s() - t_s) / t3_;
  return end_;
}

}  // namespace sandwright::fake
