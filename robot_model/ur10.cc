#include "robot_model/ur10.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kNearSingular = 1e-4;
// Below this sin q5 the split between q4 and q6 is rounding noise.
constexpr double kJoint6Free = 1e-8;
constexpr double kPolishAbove = 1e-12;
// A pose at full stretch overshoots by rounding; Newton cannot mend it, so it counts as reached.
constexpr double kReachRounding = 1e-12;

double WrapAngle(double angle) {
  if (angle > -kPi && angle <= kPi) return angle;  // most are; std::remainder is slow
  const double wrapped = std::remainder(angle, 2 * kPi);
  return wrapped <= -kPi ? wrapped + 2 * kPi : wrapped;
}

// Twist that moves `from` to `to`, first order.
Vector6 PoseError(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
  Vector6 error;
  error.head<3>() = to.translation() - from.translation();
  const Eigen::Matrix3d R = to.linear() * from.linear().transpose();
  error.tail<3>() = 0.5 * Eigen::Vector3d(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1));
  return error;
}

}  // namespace

JointAngles JointAngles::FromList(const std::vector<double>& six) {
  SAND_CHECK(six.size() == 6, six.size());
  JointAngles q;
  std::ranges::copy(six, q.rad.begin());
  return q;
}

Ur10::Ur10(const DhParameters& dh) : dh_(dh) {
  for (const auto* list : {&dh.a_m, &dh.d_m, &dh.alpha_rad, &dh.theta_rad})
    SAND_CHECK(list->size() == 6, list->size());
  for (size_t i = 0; i < 6; ++i) {
    cos_alpha_[i] = std::cos(dh.alpha_rad[i]);
    sin_alpha_[i] = std::sin(dh.alpha_rad[i]);
  }
  // cos(pi/2) is not zero in floating point; nominal twists are meant to be exact.
  for (size_t i : {0, 3, 4}) {
    if (std::abs(cos_alpha_[i]) < 1e-15) cos_alpha_[i] = 0;
  }
  a2_ = dh.a_m[1], a3_ = dh.a_m[2];
  d1_ = dh.d_m[0], d5_ = dh.d_m[4], d6_ = dh.d_m[5];
  d4_ = dh.d_m[1] + dh.d_m[2] + dh.d_m[3];  // joints 2 to 4 are parallel: their offsets add up
}

Eigen::Isometry3d Ur10::Forward(const JointAngles& q) const {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < 6; ++i) {
    const double angle = q[static_cast<int>(i)] + dh_.theta_rad[i];
    const double c = std::cos(angle), s = std::sin(angle), ca = cos_alpha_[i], sa = sin_alpha_[i];
    Eigen::Matrix3d A;
    A << c, -s * ca, s * sa, s, c * ca, -c * sa, 0, sa, ca;
    p += R * Eigen::Vector3d(dh_.a_m[i] * c, dh_.a_m[i] * s, dh_.d_m[i]);
    R = R * A;
  }
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.linear() = R;
  X.translation() = p;
  return X;
}

Matrix6 Ur10::Jacobian(const JointAngles& q) const {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector3d, 6> axis, origin;
  for (size_t i = 0; i < 6; ++i) {
    axis[i] = R.col(2);
    origin[i] = p;
    const double angle = q[static_cast<int>(i)] + dh_.theta_rad[i];
    const double c = std::cos(angle), s = std::sin(angle), ca = cos_alpha_[i], sa = sin_alpha_[i];
    Eigen::Matrix3d A;
    A << c, -s * ca, s * sa, s, c * ca, -c * sa, 0, sa, ca;
    p += R * Eigen::Vector3d(dh_.a_m[i] * c, dh_.a_m[i] * s, dh_.d_m[i]);
    R = R * A;
  }
  Matrix6 J;
  for (size_t i = 0; i < 6; ++i) {
    J.col(static_cast<int>(i)).head<3>() = axis[i].cross(p - origin[i]);
    J.col(static_cast<int>(i)).tail<3>() = axis[i];
  }
  return J;
}

std::optional<IkSolution> Ur10::Inverse(const Eigen::Isometry3d& X_WF, Branch branch,
                                        double joint6_rad) const {
  SAND_CHECK(branch >= 0 && branch < kBranches, branch);
  const bool shoulder_turned = branch & 4;
  const double wrist_sign = branch & 2 ? -1 : 1, elbow_sign = branch & 1 ? -1 : 1;
  const Eigen::Matrix3d R = X_WF.linear();
  const Eigen::Vector3d p = X_WF.translation();

  // Joint 1: the wrist's centre (origin of frame 5) lies d4 beside the plane of the arm.
  const Eigen::Vector3d p5 = p - d6_ * R.col(2);
  const double radius = std::hypot(p5.x(), p5.y());
  if (radius < std::abs(d4_) - kReachRounding) return std::nullopt;
  const double aside = std::asin(std::clamp(d4_ / radius, -1.0, 1.0)),
               bearing = std::atan2(p5.y(), p5.x());
  const double q1 = shoulder_turned ? bearing + kPi - aside : bearing + aside;
  const double c1 = std::cos(q1), s1 = std::sin(q1);

  // Joints 5 and 6: the arm plane's normal seen from the flange is (s5 c6, -s5 s6, c5).
  const Eigen::Vector3d normal(s1, -c1, 0);
  const Eigen::Vector3d n = R.transpose() * normal;
  const double sin5 = std::hypot(n.x(), n.y());
  const bool joint6_free = sin5 < kJoint6Free;
  const double q5 = std::atan2(wrist_sign * sin5, n.z());
  const double q6 = joint6_free ? joint6_rad + dh_.theta_rad[5]
                                : std::atan2(-wrist_sign * n.y(), wrist_sign * n.x());
  const double c5 = std::cos(q5), c6 = std::cos(q6), s6 = std::sin(q6);

  // Sum of joints 2 to 4 in the arm's plane, whose axes are e1 (outward) and e2 (up).
  const Eigen::Vector3d e1(c1, s1, 0), e2 = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d u = R * Eigen::Vector3d(c5 * c6, -c5 * s6, -std::sin(q5));
  const double q234 = std::atan2(u.dot(e2), u.dot(e1));
  const double x = p5.dot(e1) - d5_ * std::sin(q234);
  const double y = p5.z() - d1_ + d5_ * std::cos(q234);

  // Joints 2 and 3: two links to (x, y).
  double c3 = (x * x + y * y - a2_ * a2_ - a3_ * a3_) / (2 * a2_ * a3_);
  if (std::abs(c3) > 1 + kReachRounding) return std::nullopt;
  c3 = std::clamp(c3, -1.0, 1.0);
  const double s3 = elbow_sign * std::sqrt((1 - c3) * (1 + c3));
  const double q3 = std::atan2(s3, c3);
  const double q2 = std::atan2(y, x) - std::atan2(a3_ * s3, a2_ + a3_ * c3);

  IkSolution solution;
  solution.branch = branch;
  solution.joint6_free = joint6_free;
  solution.near_singular = sin5 < kNearSingular || std::abs(s3) < kNearSingular ||
                           radius - std::abs(d4_) < kNearSingular * std::abs(d4_);
  solution.q.rad << q1, q2, q3, q234 - q2 - q3, q5, q6;
  for (int i = 0; i < 6; ++i)
    solution.q.rad[i] = WrapAngle(solution.q[i] - dh_.theta_rad[static_cast<size_t>(i)]);
  solution.q = Polish(solution.q, X_WF);
  return solution;
}

// Newton on the pose error; a step is kept only where it helps, so a
// singular Jacobian does no harm.
JointAngles Ur10::Polish(JointAngles q, const Eigen::Isometry3d& X_WF) const {
  Vector6 error = PoseError(Forward(q), X_WF);
  for (int step = 0; step < 6 && error.norm() > kPolishAbove; ++step) {
    const Matrix6 J = Jacobian(q);
    // Damped by the error itself: quadratic convergence, bounded steps near singularities.
    const Matrix6 normal = J * J.transpose() + error.squaredNorm() * Matrix6::Identity();
    JointAngles next;
    next.rad = q.rad + J.transpose() * normal.partialPivLu().solve(error);
    const Vector6 next_error = PoseError(Forward(next), X_WF);
    if (!(next_error.norm() < error.norm())) break;
    q = next;
    error = next_error;
  }
  for (double& angle : q.rad) angle = WrapAngle(angle);
  return q;
}

std::vector<IkSolution> Ur10::Inverse(const Eigen::Isometry3d& X_WF, double joint6_rad) const {
  std::vector<IkSolution> solutions;
  solutions.reserve(kBranches);
  for (Branch branch = 0; branch < kBranches; ++branch) {
    auto solution = Inverse(X_WF, branch, joint6_rad);
    if (!solution) continue;
    // With joint 6 free the two wrists are one.
    if (solution->joint6_free && (branch & 2)) continue;
    solutions.push_back(*solution);
  }
  return solutions;
}

double SmallestSingularValue(const Matrix6& jacobian) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(jacobian * jacobian.transpose(),
                                                      Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[0]));
}

JointAngles NearestTurns(JointAngles q, const JointAngles& reference) {
  for (int i = 0; i < 6; ++i) q.rad[i] -= 2 * kPi * std::round((q[i] - reference[i]) / (2 * kPi));
  return q;
}

}  // namespace sandwright
