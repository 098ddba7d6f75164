#include "robot_model/calibration/hand_eye.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "data/base/error.h"
#include "data/base/random.h"
#include "robot_model/calibration/board_view.h"
#include "robot_model/calibration/leave_one_out.h"

namespace sandwright {
namespace {

constexpr int kSubsets = 200;
constexpr size_t kSubset = 4;
// A frame this far off is never called wrong: noise of a good camera.
constexpr double kNeverWrong_m = 0.003;
constexpr const char* kPolished = "reprojection";

using Views = std::vector<BoardView>;
using Indices = std::vector<size_t>;

Indices AllOf(const Views& views) {
  Indices all(views.size());
  std::iota(all.begin(), all.end(), size_t{0});
  return all;
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// How far each view's board lies from where the median view has it [m]: rms over its outer points,
// so that a board that is turned counts too.
std::vector<double> Deviations(const Views& views, const HandEye& poses,
                               const CharucoBoard& board) {
  std::vector<double> square(views.size(), 0.0);
  for (const int x : {0, board.columns})
    for (const int y : {0, board.rows}) {
      const Eigen::Vector3d corner(x * board.square_m, y * board.square_m, 0);
      std::vector<Eigen::Vector3d> seen_W;
      for (const BoardView& view : views) seen_W.push_back(poses.BoardOf(view) * corner);
      Eigen::Vector3d middle;
      for (int axis = 0; axis < 3; ++axis) {
        std::vector<double> values;
        for (const Eigen::Vector3d& p : seen_W) values.push_back(p[axis]);
        middle[axis] = Median(values);
      }
      for (size_t i = 0; i < views.size(); ++i) square[i] += (seen_W[i] - middle).squaredNorm() / 4;
    }
  for (double& value : square) value = std::sqrt(value);
  return square;
}

// The deviations under the poses that suit at least half of the views best (least median of squares
// over small subsets): wrong frames have no say in them.
std::vector<double> RobustDeviations(const Views& views, const CharucoBoard& board) {
  RandomStream stream(1, StreamId("hand-eye subsets"));
  std::vector<double> best;
  for (int round = 0; round < kSubsets; ++round) {
    Indices in = AllOf(views);
    for (size_t i = 0; i < kSubset; ++i) std::swap(in[i], in[i + stream.Index(in.size() - i)]);
    in.resize(kSubset);
    const auto deviations = Deviations(views, SolveHandEye(views, in, "park"), board);
    const double median = Median(deviations);
    if (std::isfinite(median) && (best.empty() || median < Median(best))) best = deviations;
  }
  return best;
}

double WrongAbove(const std::vector<double>& deviations) {
  // Three standard deviations, estimated from the median (1.4826: of a normal distribution).
  return std::max(kNeverWrong_m, 3 * 1.4826 * Median(deviations));
}

// Moves the views that stand elsewhere out of `views`, by name into `refused`.
void LeaveOutWrong(Views& views, const CharucoBoard& board, std::vector<std::string>& refused) {
  if (views.size() < kMinHandEyeFrames) return;
  std::vector<double> deviations = RobustDeviations(views, board);
  if (deviations.empty()) return;
  // Subsets are noisy: once more with the poses of all that agree.
  Indices agree;
  for (const size_t i : AllOf(views))
    if (deviations[i] <= WrongAbove(deviations)) agree.push_back(i);
  deviations = Deviations(views, SolveHandEye(views, agree, "park"), board);
  const double limit_m = WrongAbove(deviations);
  Views right;
  for (const size_t i : AllOf(views)) {
    if (deviations[i] <= limit_m)
      right.push_back(views[i]);
    else
      refused.push_back(fmt::format("{}: the board stands {:.1f} mm from where the other frames have "
                                    "it; allowed: {:.1f} mm. Joints of another picture?",
                                    views[i].name, 1e3 * deviations[i], 1e3 * limit_m));
  }
  views = std::move(right);
}

// Rms turn of the flange between two views about the second of its principal axes.
double RotationSpread(const Views& views) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  double pairs = 0;
  for (size_t i = 0; i < views.size(); ++i)
    for (size_t j = 0; j < i; ++j, ++pairs) {
      const Eigen::AngleAxisd turn(views[i].X_WF.linear().transpose() * views[j].X_WF.linear());
      const Eigen::Vector3d r = turn.angle() * turn.axis();
      scatter += r * r.transpose();
    }
  if (pairs == 0) return 0;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(scatter / pairs);
  return std::sqrt(std::max(0.0, axes.eigenvalues()[1]));
}

// Errors of one view's board against a solution: of its middle, and of its orientation.
double Shift_m(const HandEye& poses, const BoardView& view, const CharucoBoard& board) {
  const Eigen::Vector3d middle(board.columns * board.square_m / 2, board.rows * board.square_m / 2,
                               0);
  return (poses.BoardOf(view) * middle - poses.X_WBoard * middle).norm();
}
double Turn_rad(const HandEye& poses, const BoardView& view) {
  return Eigen::AngleAxisd(poses.BoardOf(view).linear().transpose() * poses.X_WBoard.linear())
      .angle();
}

void CheckViews(const Views& views, size_t frames, const HandEyeCalibration& result) {
  std::vector<std::string> reasons;
  if (views.size() < kMinHandEyeFrames)
    reasons.push_back(fmt::format("{} frames can be used; at least {} are needed", views.size(),
                                  kMinHandEyeFrames));
  if (4 * result.refused.size() > frames)
    reasons.push_back(fmt::format("{} of {} frames had to be left out; allowed: a quarter",
                                  result.refused.size(), frames));
  if (views.size() >= 2 && result.rotation_spread_rad < kMinRotationSpread_rad)
    reasons.push_back(fmt::format(
        "the flange turns by {:.3f} rad rms about its second axis; at least {} is needed. Tilt it "
        "about two axes, by 20 degrees and more",
        result.rotation_spread_rad, kMinRotationSpread_rad));
  if (reasons.empty()) return;
  reasons.insert(reasons.end(), result.refused.begin(), result.refused.end());
  throw Error("hand-eye: not calibrated", reasons);
}

// All solvers by the frames that each was not given.
void CrossValidate(const Views& views, const CharucoBoard& board, const CameraModel& camera,
                   HandEyeCalibration& result) {
  const auto validate = [&](const std::string& name, const auto& fit) {
    std::vector<double> turns_rad, shifts_m;
    for (size_t out = 0; out < views.size(); ++out) {
      Indices in = AllOf(views);
      in.erase(in.begin() + static_cast<std::ptrdiff_t>(out));
      const HandEye poses = fit(in);
      shifts_m.push_back(Shift_m(poses, views[out], board));
      turns_rad.push_back(Turn_rad(poses, views[out]));
    }
    result.solvers.push_back({name, RootMeanSquare(shifts_m), RootMeanSquare(turns_rad)});
  };
  const auto better = [](const HandEyeSolver& a, const HandEyeSolver& b) {
    return a.held_out_m < b.held_out_m || std::isnan(b.held_out_m);
  };
  for (const char* name : kHandEyeSolvers)
    validate(name, [&](const Indices& in) { return SolveHandEye(views, in, name); });
  const std::string start = std::ranges::min_element(result.solvers, better)->name;
  validate(kPolished, [&](const Indices& in) {
    return PolishHandEye(views, in, camera, SolveHandEye(views, in, start));
  });
  const HandEyeSolver& taken = *std::ranges::min_element(result.solvers, better);
  HandEye poses =
      SolveHandEye(views, AllOf(views), taken.name == kPolished ? start : taken.name);
  if (taken.name == kPolished) poses = PolishHandEye(views, AllOf(views), camera, poses);
  std::vector<double> shifts_m;
  for (const BoardView& view : views) shifts_m.push_back(Shift_m(poses, view, board));
  result.X_FC = poses.X_FC;
  result.X_WBoard = poses.X_WBoard;
  result.solver = taken.name;
  result.error = {static_cast<int64_t>(views.size()), RootMeanSquare(shifts_m), taken.held_out_m,
                  taken.held_out_rad};
}

}  // namespace

HandEyeCalibration CalibrateHandEye(const std::vector<MarkedFrame>& frames,
                                    const std::vector<JointAngles>& joints,
                                    const CharucoBoard& board, const Workcell& workcell) {
  if (frames.size() != joints.size())
    throw Error(fmt::format("{} frames and {} joint vectors; one joint vector a frame is needed",
                            frames.size(), joints.size()));
  const Ur10 arm(workcell.kinematics);
  HandEyeCalibration result;
  Views views;
  for (size_t i = 0; i < frames.size(); ++i) {
    try {
      views.push_back(ViewBoard(frames[i], arm.Forward(joints[i]), board, workcell.camera));
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::kRefused) throw;
      result.refused.push_back(e.reasons().front());
    }
  }
  LeaveOutWrong(views, board, result.refused);
  result.rotation_spread_rad = RotationSpread(views);
  CheckViews(views, frames.size(), result);
  CrossValidate(views, board, workcell.camera, result);
  return result;
}

}  // namespace sandwright
