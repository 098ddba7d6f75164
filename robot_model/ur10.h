// Kinematics of the Universal Robots UR10 (CB3) in double precision.
//
// Frames: W the base as the pendant shows it (UR "Base"), F the flange (tool0). Joint angles in
// rad, lengths in m. Standard Denavit-Hartenberg parameters.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <numbers>
#include <optional>
#include <vector>

#include "data/base/config.h"

namespace sandwright {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// Angles of the six joints, base to wrist 3 [rad].
struct JointAngles {
  Vector6 rad = Vector6::Zero();

  static JointAngles FromList(const std::vector<double>& six);
  double operator[](int joint) const { return rad[joint]; }
};

// One row a joint: T = Rz(theta + q) Tz(d) Tx(a) Rx(alpha). The defaults are the nominal UR10 CB3;
// a controller's factory calibration moves the flange by millimetres.
struct DhParameters {
  std::vector<double> a_m = {0, -0.612, -0.5723, 0, 0, 0};
  std::vector<double> d_m = {0.1273, 0, 0, 0.163941, 0.1157, 0.0922};
  std::vector<double> alpha_rad = {std::numbers::pi / 2,  0, 0, std::numbers::pi / 2,
                                   -std::numbers::pi / 2, 0};
  std::vector<double> theta_rad = {0, 0, 0, 0, 0, 0};

  void Fields(FieldList& f) {
    f.Add("a_m", a_m, "Denavit-Hartenberg a of the six joints [m]");
    f.Add("d_m", d_m, "d [m]");
    f.Add("alpha_rad", alpha_rad, "alpha [rad]");
    f.Add("theta_rad", theta_rad, "offset of the joint angle [rad]");
  }
};

// One of the eight ways to reach a pose, 0..7: 4 * (shoulder turned) + 2 * (wrist 2 negative) +
// (elbow negative). It stays the same along a path that crosses no singularity.
using Branch = int;
inline constexpr int kBranches = 8;

struct IkSolution {
  JointAngles q;  // each in (-pi, pi]
  Branch branch = 0;
  bool near_singular =
      false;  // branches meet here: within 1e-4 of sin q5 = 0, sin q3 = 0 or the axis
  bool joint6_free = false;  // sin q5 = 0: only q4 +- q6 matters; q6 was taken as asked
};

class Ur10 {
 public:
  Ur10() : Ur10(DhParameters{}) {}
  explicit Ur10(const DhParameters& dh);

  // X_WF.
  Eigen::Isometry3d Forward(const JointAngles& q) const;
  // Columns: linear velocity of F's origin (m/rad), then angular velocity (rad/rad), in W.
  Matrix6 Jacobian(const JointAngles& q) const;

  // All branches that reach X_WF, at most eight, in order of branch; none where it is out of reach.
  // Closed form, then Newton steps to 1e-12 where rounding (near singularities) or calibrated
  // parameters leave a residual. Where joint 6 is free it is set to `joint6_rad`.
  std::vector<IkSolution> Inverse(const Eigen::Isometry3d& X_WF, double joint6_rad = 0) const;
  // One branch alone.
  std::optional<IkSolution> Inverse(const Eigen::Isometry3d& X_WF, Branch branch,
                                    double joint6_rad = 0) const;

 private:
  JointAngles Polish(JointAngles q, const Eigen::Isometry3d& X_WF) const;

  DhParameters dh_;
  std::array<double, 6> cos_alpha_, sin_alpha_;
  double a2_, a3_, d1_, d4_, d5_, d6_;  // of the closed form, which is exact for nominal twists
};

// Smallest singular value of a Jacobian (unit mixed of m and rad, as
// all lengths here are near 1 m).
double SmallestSingularValue(const Matrix6& jacobian);

// `q` with each joint shifted by whole turns to within half a turn of `reference`.
JointAngles NearestTurns(JointAngles q, const JointAngles& reference);

}  // namespace sandwright
