#include "robot_model/calibration/board_view.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/SVD>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <unsupported/Eigen/NonLinearOptimization>

#include "data/base/error.h"
#include "robot_model/workcell.h"

namespace sandwright {
namespace {

constexpr size_t kMinCorners = 8;
constexpr double kMaxReprojection_px = 1;

cv::Matx33d MatrixOf(const CameraModel& camera) {
  return {camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1};
}

cv::Vec<double, 5> DistortionOf(const CameraModel& camera) {
  return {camera.k1, camera.k2, camera.p1, camera.p2, camera.k3};
}

Eigen::Isometry3d PoseOf(const cv::Vec3d& rotation, const cv::Vec3d& translation) {
  return PoseSetting{{translation[0], translation[1], translation[2]},
                     {rotation[0], rotation[1], rotation[2]}}
      .ToIsometry();
}

std::pair<cv::Vec3d, cv::Vec3d> VectorsOf(const Eigen::Isometry3d& X) {
  const PoseSetting pose = PoseSetting::FromIsometry(X);
  return {cv::Vec3d(pose.rotation_vector_rad.data()), cv::Vec3d(pose.translation_m.data())};
}

// Misses of the seen corners [px], u and v in turn.
std::vector<cv::Point2d> Misses(const BoardView& view, const Eigen::Isometry3d& X_CBoard,
                                const CameraModel& camera) {
  const auto [rotation, translation] = VectorsOf(X_CBoard);
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(view.corners_Board, rotation, translation, MatrixOf(camera),
                    DistortionOf(camera), pixels);
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] -= view.pixels[i];
  return pixels;
}

// What MINPACK asks for: the misses of all views for twelve numbers, X_FC and X_WBoard.
struct ReprojectionMisses {
  using Scalar = double;
  using InputType = Eigen::VectorXd;
  using ValueType = Eigen::VectorXd;
  using JacobianType = Eigen::MatrixXd;
  enum { InputsAtCompileTime = Eigen::Dynamic, ValuesAtCompileTime = Eigen::Dynamic };

  const std::vector<BoardView>& views;
  const std::vector<size_t>& in;
  const CameraModel& camera;

  int inputs() const { return 12; }
  int values() const {
    size_t count = 0;
    for (const size_t i : in) count += 2 * views[i].pixels.size();
    return static_cast<int>(count);
  }
  static Eigen::VectorXd Pack(const HandEye& poses) {
    Eigen::VectorXd x(12);
    for (const auto& [at, X] : {std::pair{0, &poses.X_FC}, std::pair{6, &poses.X_WBoard}}) {
      const PoseSetting pose = PoseSetting::FromIsometry(*X);
      x.segment<3>(at) = Eigen::Vector3d(pose.rotation_vector_rad.data());
      x.segment<3>(at + 3) = Eigen::Vector3d(pose.translation_m.data());
    }
    return x;
  }
  static HandEye Unpack(const Eigen::VectorXd& x) {
    const auto pose = [&](int at) {
      return PoseOf({x[at], x[at + 1], x[at + 2]}, {x[at + 3], x[at + 4], x[at + 5]});
    };
    return {pose(0), pose(6)};
  }
  int operator()(const Eigen::VectorXd& x, Eigen::VectorXd& misses) const {
    const HandEye poses = Unpack(x);
    Eigen::Index row = 0;
    for (const size_t i : in) {
      const Eigen::Isometry3d X_CBoard = (views[i].X_WF * poses.X_FC).inverse() * poses.X_WBoard;
      for (const cv::Point2d& miss : Misses(views[i], X_CBoard, camera)) {
        misses[row++] = miss.x;
        misses[row++] = miss.y;
      }
    }
    return 0;
  }
};

// Mean of poses that lie near each other; the rotation in the chordal sense.
Eigen::Isometry3d MeanPose(const std::vector<Eigen::Isometry3d>& poses) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (const auto& X : poses) {
    sum += X.linear();
    p += X.translation() / static_cast<double>(poses.size());
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant());
  Eigen::Isometry3d mean = Eigen::Isometry3d::Identity();
  mean.linear() = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  mean.translation() = p;
  return mean;
}

}  // namespace

BoardView ViewBoard(const MarkedFrame& frame, const Eigen::Isometry3d& X_WF,
                    const CharucoBoard& board, const CameraModel& camera) {
  const auto refuse = [&](const std::string& reason) {
    throw Error("frame not used", std::vector<std::string>{frame.name + ": " + reason});
  };
  BoardView view{frame.name, X_WF, Eigen::Isometry3d::Identity(), {}, {}};
  const auto corners = board.Corners();
  for (const MarkedPoint& point : frame.points) {
    if (point.id < 0 || point.id >= static_cast<int>(corners.size()))
      refuse(fmt::format("corner {}; the board has 0..{}", point.id, corners.size() - 1));
    const Eigen::Vector3d& p = corners[static_cast<size_t>(point.id)];
    view.corners_Board.emplace_back(p.x(), p.y(), p.z());
    view.pixels.emplace_back(point.pixel.x(), point.pixel.y());
  }
  if (view.pixels.size() < kMinCorners)
    refuse(fmt::format("{} corners of the board seen; at least {} are needed", view.pixels.size(),
                       kMinCorners));
  cv::Vec3d rotation, translation;
  // IPPE tells a flat board from its mirror pose; the refinement takes its last pixels.
  if (!cv::solvePnP(view.corners_Board, view.pixels, MatrixOf(camera), DistortionOf(camera),
                    rotation, translation, false, cv::SOLVEPNP_IPPE))
    refuse("no pose of the board fits");
  cv::solvePnPRefineLM(view.corners_Board, view.pixels, MatrixOf(camera), DistortionOf(camera),
                       rotation, translation);
  view.X_CBoard = PoseOf(rotation, translation);
  double square = 0;
  for (const cv::Point2d& miss : Misses(view, view.X_CBoard, camera)) square += miss.dot(miss);
  const double rms_px = std::sqrt(square / static_cast<double>(view.pixels.size()));
  if (!(rms_px <= kMaxReprojection_px))
    refuse(fmt::format("the corners miss the board's shape by {:.1f} px rms; allowed: {} px", rms_px,
                       kMaxReprojection_px));
  return view;
}

HandEye SolveHandEye(const std::vector<BoardView>& views, const std::vector<size_t>& in,
                     const std::string& solver) {
  static const std::map<std::string, cv::HandEyeCalibrationMethod> methods = {
      {"tsai", cv::CALIB_HAND_EYE_TSAI},
      {"park", cv::CALIB_HAND_EYE_PARK},
      {"horaud", cv::CALIB_HAND_EYE_HORAUD},
      {"andreff", cv::CALIB_HAND_EYE_ANDREFF},
      {"daniilidis", cv::CALIB_HAND_EYE_DANIILIDIS}};
  SAND_CHECK(methods.contains(solver) && in.size() >= 3, solver, in.size());
  std::vector<cv::Mat> R_WF, t_WF, R_CBoard, t_CBoard;
  for (const size_t i : in) {
    cv::Mat R, t, S, s;
    cv::eigen2cv(Eigen::Matrix3d(views[i].X_WF.linear()), R);
    cv::eigen2cv(Eigen::Vector3d(views[i].X_WF.translation()), t);
    cv::eigen2cv(Eigen::Matrix3d(views[i].X_CBoard.linear()), S);
    cv::eigen2cv(Eigen::Vector3d(views[i].X_CBoard.translation()), s);
    R_WF.push_back(R), t_WF.push_back(t), R_CBoard.push_back(S), t_CBoard.push_back(s);
  }
  cv::Mat R_FC, t_FC;
  cv::calibrateHandEye(R_WF, t_WF, R_CBoard, t_CBoard, R_FC, t_FC, methods.at(solver));
  HandEye result;
  Eigen::Matrix3d R;
  Eigen::Vector3d t;
  cv::cv2eigen(R_FC, R);
  cv::cv2eigen(t_FC, t);
  result.X_FC.linear() = R;
  result.X_FC.translation() = t;
  std::vector<Eigen::Isometry3d> boards;
  for (const size_t i : in) boards.push_back(result.BoardOf(views[i]));
  result.X_WBoard = MeanPose(boards);
  return result;
}

HandEye PolishHandEye(const std::vector<BoardView>& views, const std::vector<size_t>& in,
                      const CameraModel& camera, const HandEye& start) {
  using Problem = Eigen::NumericalDiff<ReprojectionMisses>;
  Problem problem(ReprojectionMisses{views, in, camera});
  Eigen::LevenbergMarquardt<Problem> solver(problem);
  solver.parameters.maxfev = 400;
  Eigen::VectorXd x = ReprojectionMisses::Pack(start);
  solver.minimize(x);
  return ReprojectionMisses::Unpack(x);
}

}  // namespace sandwright
