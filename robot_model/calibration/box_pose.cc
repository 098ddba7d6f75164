#include "robot_model/calibration/box_pose.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

#include "data/base/error.h"
#include "robot_model/calibration/leave_one_out.h"

namespace sandwright {
namespace {

constexpr size_t kMinMeasurements = 4;

// Either kind of measurement says: of X_WB p_B - p_W, what `seen` leaves is zero. A touch on a wall's
// edge knows nothing along that edge, a sight nothing along its ray.
struct Constraint {
  std::string name;
  Eigen::Vector3d p_B, p_W;
  Eigen::Matrix3d seen;
  bool seen_in_B;  // frame in which `seen` is expressed

  // `seen` as it acts on vectors expressed in W.
  Eigen::Matrix3d Rows(const Eigen::Isometry3d& X_WB) const {
    if (!seen_in_B) return seen;
    return seen * X_WB.linear().transpose();
  }
  // The point of the box, in W, whose motion with the box changes the miss.
  Eigen::Vector3d Moved(const Eigen::Isometry3d& X_WB) const {
    return seen_in_B ? p_W : Eigen::Vector3d(X_WB * p_B);
  }
  Eigen::Vector3d Miss(const Eigen::Isometry3d& X_WB) const {
    const Eigen::Vector3d miss_W = X_WB * p_B - p_W;
    return Rows(X_WB) * miss_W;
  }
};

struct Fit {
  Eigen::Isometry3d X_WB;
  double dilution = 0;
};

std::vector<Eigen::Vector3d> RimCorners(const BoxSettings& box) {
  std::vector<Eigen::Vector3d> corners;
  for (const double x : {0.0, box.width_m})
    for (const double y : {0.0, box.depth_m}) corners.emplace_back(x, y, box.wall_height_m);
  return corners;
}

// d(X p)/d(twist) for a twist about `centre`: shift, then turn.
Eigen::Matrix<double, 3, 6> PointJacobian(const Eigen::Vector3d& p_W,
                                          const Eigen::Vector3d& centre) {
  const Eigen::Vector3d r = p_W - centre;
  Eigen::Matrix<double, 3, 6> J;
  J << Eigen::Matrix3d::Identity(),
      (Eigen::Matrix3d() << 0, r.z(), -r.y(), -r.z(), 0, r.x(), r.y(), -r.x(), 0).finished();
  return J;
}

// Gauss-Newton with bounded turns; fitting a rigid body needs no good start.
Fit Solve(const std::vector<Constraint>& all, const std::vector<size_t>& in,
          const Workcell& cell) {
  Fit fit{cell.X_WB.ToIsometry()};
  const Eigen::Vector3d middle_B(cell.box.width_m / 2, cell.box.depth_m / 2,
                                 cell.box.wall_height_m);
  Matrix6 information;
  for (int step = 0; step < 100; ++step) {
    const Eigen::Vector3d centre = fit.X_WB * middle_B;
    information = 1e-9 * Matrix6::Identity();
    Vector6 gradient = Vector6::Zero();
    for (const size_t i : in) {
      const Eigen::Matrix<double, 3, 6> J =
          all[i].Rows(fit.X_WB) * PointJacobian(all[i].Moved(fit.X_WB), centre);
      information += J.transpose() * J;
      gradient += J.transpose() * all[i].Miss(fit.X_WB);
    }
    const Vector6 twist = -information.ldlt().solve(gradient);
    const double turn = std::min(twist.tail<3>().norm(), 0.5);
    if (turn > 0) {
      const Eigen::AngleAxisd by(turn, twist.tail<3>().normalized());
      fit.X_WB.linear() = by.toRotationMatrix() * fit.X_WB.linear();
    }
    fit.X_WB.translation() = centre + twist.head<3>() - fit.X_WB.linear() * middle_B;
    if (twist.norm() < 1e-10) break;
  }
  const Matrix6 covariance = information.inverse();
  for (const Eigen::Vector3d& corner : RimCorners(cell.box)) {
    const auto J = PointJacobian(fit.X_WB * corner, fit.X_WB * middle_B);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(J * covariance * J.transpose());
    fit.dilution = std::max(fit.dilution, std::sqrt(spread.eigenvalues()[2]));
  }
  return fit;
}

Constraint OfTouch(const RimTouch& touch, size_t index, const BoxSettings& box) {
  Constraint constraint{fmt::format("touch {} (at {})", index + 1, touch.at),
                        Eigen::Vector3d(0, 0, box.wall_height_m), touch.p_W,
                        Eigen::Vector3d(0, 0, 1).asDiagonal(), true};
  for (size_t i = 0; i + 1 < touch.at.size(); i += 2) {
    const int axis = touch.at[i] == 'x' ? 0 : 1;
    const double size_m = axis == 0 ? box.width_m : box.depth_m;
    constraint.seen(axis, axis) = 1;
    constraint.p_B[axis] = touch.at[i + 1] == '1' ? size_m : 0;
  }
  return constraint;
}

Constraint OfSight(const PointSight& sight) {
  const Eigen::Vector3d ray_W = (sight.X_WC.linear() * sight.ray_C).normalized();
  return {sight.name, sight.p_B, sight.X_WC.translation(),
          Eigen::Matrix3d::Identity() - ray_W * ray_W.transpose(), false};
}

// The inside between two opposite walls as they were touched.
std::optional<double> MeasuredSize(const std::vector<RimTouch>& touches,
                                   const Eigen::Isometry3d& X_WB, char axis) {
  std::array<double, 2> sum{};
  std::array<int, 2> count{};
  for (const RimTouch& touch : touches) {
    const size_t found = touch.at.find(axis);
    if (found == std::string::npos) continue;
    const auto side = static_cast<size_t>(touch.at[found + 1] - '0');
    sum[side] += (X_WB.inverse() * touch.p_W)[axis == 'x' ? 0 : 1];
    ++count[side];
  }
  if (count[0] == 0 || count[1] == 0) return std::nullopt;
  return sum[1] / count[1] - sum[0] / count[0];
}

// A reason for each size that the touches contradict.
std::vector<std::string> SizeFaults(const std::vector<RimTouch>& touches,
                                    const Eigen::Isometry3d& X_WB, const BoxSettings& box) {
  std::vector<std::string> faults;
  for (const auto& [axis, key, stated_m] :
       {std::tuple{'x', "box.width_m", box.width_m}, std::tuple{'y', "box.depth_m", box.depth_m}}) {
    const auto size_m = MeasuredSize(touches, X_WB, axis);
    if (size_m && std::abs(*size_m - stated_m) > kBoxTolerance_m)
      faults.push_back(fmt::format("{} is {:.4f}; the touches say {:.4f}, allowed: within {:.1f} mm",
                                   key, stated_m, *size_m, 1e3 * kBoxTolerance_m));
  }
  return faults;
}

// A set of constraints, solved and judged.
BoxCalibration SolveJudged(const std::vector<Constraint>& all,
                           const std::vector<RimTouch>& touches, const Workcell& cell) {
  std::vector<std::string> reasons;
  const auto refuse = [&](const std::string& reason) {
    reasons.insert(reasons.begin(), reason);
    throw Error("box: not calibrated", reasons);
  };
  if (all.size() < kMinMeasurements)
    refuse(fmt::format("{} measurements; at least {} are needed", all.size(), kMinMeasurements));
  std::vector<size_t> every(all.size());
  std::iota(every.begin(), every.end(), size_t{0});
  const Fit fit = Solve(all, every, cell);
  if (!(fit.dilution <= kMaxBoxDilution))
    refuse(fmt::format("the measurements are too alike: a corner of the rim is uncertain by {:.1f} "
                       "times the error of one; allowed: {}. Measure at all four walls, far apart",
                       fit.dilution, kMaxBoxDilution));
  const auto miss_m = [&](const Fit& solution, size_t i) {
    return all[i].Miss(solution.X_WB).norm();
  };
  const auto others = LeaveEachOut(
      all.size(), [&](const std::vector<size_t>& in) { return Solve(all, in, cell); }, miss_m);
  std::vector<double> errors_m;
  for (const size_t i : every) errors_m.push_back(miss_m(fit, i));
  const double largest_m = std::ranges::max(errors_m);
  if (largest_m > kBoxTolerance_m) {
    if (others.others_m <= kBoxTolerance_m)
      refuse(fmt::format("{} lies {:.1f} mm off what the others say; allowed: {:.1f} mm",
                         all[others.suspect].name, 1e3 * others.held_out_m[others.suspect],
                         1e3 * kBoxTolerance_m));
    reasons = SizeFaults(touches, fit.X_WB, cell.box);
    refuse(fmt::format("the measurements disagree by up to {:.1f} mm ({}), and no single one is to "
                       "blame; allowed: {:.1f} mm",
                       1e3 * largest_m,
                       all[static_cast<size_t>(std::ranges::max_element(errors_m) -
                                               errors_m.begin())]
                           .name,
                       1e3 * kBoxTolerance_m));
  }
  reasons = SizeFaults(touches, fit.X_WB, cell.box);
  if (!reasons.empty()) throw Error("box: not calibrated", reasons);
  BoxCalibration result;
  result.X_WB = fit.X_WB;
  result.dilution = fit.dilution;
  result.error = {static_cast<int64_t>(all.size()), RootMeanSquare(errors_m),
                  RootMeanSquare(others.held_out_m), 0};
  result.width_m = MeasuredSize(touches, fit.X_WB, 'x');
  result.depth_m = MeasuredSize(touches, fit.X_WB, 'y');
  return result;
}

}  // namespace

BoxCalibration CalibrateBox(const BoxMeasurements& measurements, const Workcell& cell) {
  std::vector<Constraint> touches, sights;
  for (size_t i = 0; i < measurements.touches.size(); ++i)
    touches.push_back(OfTouch(measurements.touches[i], i, cell.box));
  for (const PointSight& sight : measurements.sights) sights.push_back(OfSight(sight));
  std::vector<Constraint> all = touches;
  all.insert(all.end(), sights.begin(), sights.end());

  std::optional<double> disagreement_m;
  if (!touches.empty() && !sights.empty()) {
    const Eigen::Isometry3d X_WB_touched = SolveJudged(touches, measurements.touches, cell).X_WB;
    const Eigen::Isometry3d X_WB_seen = SolveJudged(sights, {}, cell).X_WB;
    disagreement_m = 0;
    for (const Eigen::Vector3d& corner : RimCorners(cell.box))
      disagreement_m =
          std::max(*disagreement_m, (X_WB_touched * corner - X_WB_seen * corner).norm());
    if (*disagreement_m > kBoxTolerance_m)
      throw Error("box: not calibrated",
                  {fmt::format("touches and tags place a corner of the rim {:.1f} mm apart; allowed: "
                               "{:.1f} mm. Tool or hand-eye calibration is wrong, or the tags are "
                               "not where the file says",
                               1e3 * *disagreement_m, 1e3 * kBoxTolerance_m)});
  }
  BoxCalibration result = SolveJudged(all, measurements.touches, cell);
  result.disagreement_m = disagreement_m;
  return result;
}

}  // namespace sandwright
