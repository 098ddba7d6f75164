#include "robot_model/calibration/tool_tip.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "data/base/error.h"
#include "robot_model/calibration/joint_list.h"
#include "robot_model/calibration/leave_one_out.h"

namespace sandwright {
namespace {

using Poses = std::vector<Eigen::Isometry3d>;

constexpr size_t kMinTouches = 4;

// The tip in F and the touched point in W.
struct Tip {
  Eigen::Vector3d p_FT, p_WP;
  double dilution;

  double Error_m(const Eigen::Isometry3d& X_WF) const { return (X_WF * p_FT - p_WP).norm(); }
};

// R_i p_FT + t_i = p_WP for all touches, in least squares.
Tip SolveTip(const Poses& X_WF, const std::vector<size_t>& in) {
  Eigen::MatrixXd A(3 * in.size(), 6);
  Eigen::VectorXd b(3 * in.size());
  for (size_t row = 0; row < in.size(); ++row) {
    const auto at = static_cast<Eigen::Index>(3 * row);
    A.block<3, 3>(at, 0) = X_WF[in[row]].linear();
    A.block<3, 3>(at, 3) = -Eigen::Matrix3d::Identity();
    b.segment<3>(at) = -X_WF[in[row]].translation();
  }
  const Eigen::Matrix<double, 6, 1> x = A.colPivHouseholderQr().solve(b);
  // Of the covariance for unit errors: the tip alone, the point being a nuisance.
  const Eigen::Matrix<double, 6, 6> covariance =
      (A.transpose() * A + 1e-12 * Eigen::Matrix<double, 6, 6>::Identity()).inverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(covariance.topLeftCorner<3, 3>());
  return {x.head<3>(), x.tail<3>(), std::sqrt(spread.eigenvalues()[2])};
}

Poses FlangePoses(const std::vector<JointAngles>& joints, const Workcell& cell) {
  const Ur10 arm(cell.kinematics);
  Poses poses;
  for (const JointAngles& q : joints) poses.push_back(arm.Forward(q));
  return poses;
}

std::vector<size_t> AllOf(const Poses& poses) {
  std::vector<size_t> all(poses.size());
  std::iota(all.begin(), all.end(), size_t{0});
  return all;
}

void CheckTouches(const Poses& X_WF, const Tip& tip, const LeaveOneOut& others) {
  if (tip.dilution > kMaxDilution)
    throw Error("tool: not calibrated",
                {fmt::format("the poses are too alike: the tip is uncertain by {:.1f} times the error "
                             "of one touch; allowed: {}. Turn the flange further between touches, "
                             "about two axes",
                             tip.dilution, kMaxDilution)});
  double largest_m = 0;
  for (const auto& pose : X_WF) largest_m = std::max(largest_m, tip.Error_m(pose));
  if (largest_m <= kTouchTolerance_m &&
      std::ranges::max(others.held_out_m) <= 2 * kTouchTolerance_m)
    return;
  if (others.others_m <= kTouchTolerance_m)
    throw Error("tool: not calibrated",
                {fmt::format("touch {} of `tip` is {:.1f} mm off the point that the others stand on; "
                             "allowed: {:.1f} mm",
                             others.suspect + 1, 1e3 * others.held_out_m[others.suspect],
                             1e3 * kTouchTolerance_m)});
  throw Error("tool: not calibrated",
              {fmt::format("the touches disagree by up to {:.1f} mm, and no single one is to blame; "
                           "allowed: {:.1f} mm",
                           1e3 * largest_m, 1e3 * kTouchTolerance_m)});
}

// y along the blade, z as near to the flange's as that allows, the tip between the ends.
void OrientByEdge(const Poses& ends, const Tip& tip, const Blade& blade, ToolCalibration& result) {
  const Eigen::Vector3d from = ends[0].inverse() * tip.p_WP, to = ends[1].inverse() * tip.p_WP;
  result.edge_length_m = (to - from).norm();
  const double aside_m = (0.5 * (from + to) - tip.p_FT).norm();
  std::vector<std::string> reasons;
  if (std::abs(result.edge_length_m - blade.width_m) > 2 * kTouchTolerance_m)
    reasons.push_back(fmt::format("the ends of the edge are {:.1f} mm apart; tool.blade.width_m is "
                                  "{:.1f} mm, allowed: within {:.1f} mm",
                                  1e3 * result.edge_length_m, 1e3 * blade.width_m,
                                  2e3 * kTouchTolerance_m));
  if (aside_m > 2 * kTouchTolerance_m)
    reasons.push_back(fmt::format("the tip is {:.1f} mm off the middle between the ends; allowed: "
                                  "{:.1f} mm",
                                  1e3 * aside_m, 2e3 * kTouchTolerance_m));
  const Eigen::Vector3d y = (to - from).normalized();
  if (std::abs(y.z()) > 0.5)
    reasons.push_back(fmt::format("the edge stands {:.0f} degrees off the flange's plane; allowed: 30",
                                  std::asin(std::abs(y.z())) * 180 / std::numbers::pi));
  if (!reasons.empty()) throw Error("tool: not calibrated", reasons);
  const Eigen::Vector3d x = y.cross(Eigen::Vector3d::UnitZ()).normalized();
  result.X_FT.linear() << x, y, x.cross(y);
}

}  // namespace

ToolTouches ReadToolTouches(const std::filesystem::path& file) {
  const YAML::Node root = LoadYamlNode(file);
  if (!root.IsMap())
    throw Error(file.string() + ": the keys `tip` and, optional, `edge` are needed");
  ToolTouches touches;
  touches.tip = ReadJointList(root["tip"], file.string() + ": tip");
  if (root["edge"]) {
    const auto ends = ReadJointList(root["edge"], file.string() + ": edge");
    if (ends.size() != 2)
      throw Error(fmt::format("{}: edge has {} joint vectors; 2 are needed", file.string(),
                              ends.size()));
    touches.edge = {ends[0], ends[1]};
  }
  return touches;
}

ToolCalibration CalibrateTool(const ToolTouches& touches, const Workcell& workcell) {
  if (touches.tip.size() < kMinTouches)
    throw Error("tool: not calibrated", {fmt::format("{} touches of the tip; at least {} are needed",
                                                     touches.tip.size(), kMinTouches)});
  const Poses X_WF = FlangePoses(touches.tip, workcell);
  const Tip tip = SolveTip(X_WF, AllOf(X_WF));
  const auto others = LeaveEachOut(
      X_WF.size(), [&](const std::vector<size_t>& in) { return SolveTip(X_WF, in); },
      [&](const Tip& fit, size_t i) { return fit.Error_m(X_WF[i]); });
  CheckTouches(X_WF, tip, others);

  ToolCalibration result;
  result.X_FT = workcell.tool.X_FT.ToIsometry();
  result.X_FT.translation() = tip.p_FT;
  result.dilution = tip.dilution;
  std::vector<double> errors_m;
  for (const auto& pose : X_WF) errors_m.push_back(tip.Error_m(pose));
  result.error = {static_cast<int64_t>(X_WF.size()), RootMeanSquare(errors_m),
                  RootMeanSquare(others.held_out_m), 0};
  if (touches.edge)
    OrientByEdge(FlangePoses({touches.edge->begin(), touches.edge->end()}, workcell), tip,
                 workcell.tool.blade, result);
  return result;
}

}  // namespace sandwright
