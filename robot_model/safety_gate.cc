#include "robot_model/safety_gate.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>

#include "data/base/error.h"
#include "robot_model/clearance.h"
#include "robot_model/curve_speed.h"
#include "robot_model/gate_figures.h"

namespace sandwright {
namespace {

// What the coarse sampling keeps beyond each limit, for what happens between its samples. Chosen so
// that none of 1e5 random strokes that it accepts is rejected by the fine sampling.
constexpr double kCoarseStep_m = 0.04, kCoarseVerticalStep_m = 0.07, kCoarseTurn_rad = 0.3;
constexpr double kCoarseClearance_m = 0.015, kCoarseSingular = 0.02, kCoarsePosition_rad = 0.05;
constexpr double kCoarseRates = 1.5;     // factor on speeds and accelerations
constexpr double kCoarseDuration = 1.1;  // factor on the duration
// How far beyond its margin the coarse sampling measures distances.
constexpr double kCoarseSeen_m = 0.01;
// The fine sampling looks at distances and singular values whenever a joint has moved this far.
constexpr double kFineLook_rad = 0.02;
constexpr double kFootprintStep_m = 0.005, kFootprintTurn_rad = 0.1;
// The terrain around a stroke over which hand and links may pass.
constexpr double kHandReach_m = 0.25;

struct Candidate {
  Branch branch;
  bool flipped;
  double distance_rad;  // from the reference joints
};

std::string Where(const BladePose& p) {
  return fmt::format("({:.3f}, {:.3f}, {:.3f}) m", p.x_m, p.y_m, p.z_m);
}

}  // namespace

struct SafetyGate::Impl {
  explicit Impl(const Workcell& workcell)
      : cell(workcell),
        kinematics(workcell),
        clearance(workcell),
        fine(workcell.limits, 0, 0, 0, 1),
        coarse(workcell.limits, kCoarseClearance_m, kCoarseSingular, kCoarsePosition_rad,
               kCoarseRates) {}

  void CheckTerrain(const HeightMap& terrain, std::vector<std::string>& reasons) const;
  void CheckShape(const Stroke& stroke, std::vector<std::string>& reasons) const;
  void CheckBlade(const ToolPath& path, const HeightMap& terrain,
                  std::vector<std::string>& reasons) const;
  double SandTop(const ToolPath& path, const HeightMap& terrain) const;
  std::vector<Candidate> Candidates(const BladePose& start, const JointAngles& near) const;
  void LookAt(const JointAngles& q, double sand_top_m, const GateLimits& limits,
              ClearanceModel::Lease& lease, ArmFigures& figures) const;
  ArmFigures TryCoarse(const std::vector<PathPiece>& pieces, const Candidate& candidate,
                       const JointAngles& near, double sand_top_m,
                       ClearanceModel::Lease& lease) const;
  ArmFigures TryFine(std::span<const JointAngles> knots, double sand_top_m,
                     ClearanceModel::Lease& lease) const;
  void CheckArm(const Stroke& stroke, double sand_top_m, GateSampling sampling,
                const JointAngles& near, GateVerdict& verdict) const;

  Workcell cell;
  BladeKinematics kinematics;
  ClearanceModel clearance;
  GateLimits fine, coarse;
  mutable std::once_flag reach_once;
  mutable ReachMap reach;
};

void SafetyGate::Impl::CheckTerrain(const HeightMap& terrain,
                                    std::vector<std::string>& reasons) const {
  if (terrain.datum != Datum::kFloor)
    reasons.push_back(
        "terrain: datum is relative; the gate needs heights above the box floor (floor)");
  if (std::abs(terrain.width_m() - cell.box.width_m) > 1e-6 ||
      std::abs(terrain.depth_m() - cell.box.depth_m) > 1e-6)
    reasons.push_back(
        fmt::format("terrain: {:.3f} x {:.3f} m; the box of the workcell is {:.3f} x {:.3f} m",
                    terrain.width_m(), terrain.depth_m(), cell.box.width_m, cell.box.depth_m));
}

void SafetyGate::Impl::CheckShape(const Stroke& stroke, std::vector<std::string>& reasons) const {
  const MotionLimits& limits = cell.limits;
  Eigen::Vector3d low = stroke.control_points_m.front(), high = low;
  for (const Eigen::Vector3d& point : stroke.control_points_m)
    low = low.cwiseMin(point), high = high.cwiseMax(point);
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = (high - low)[axis];
    if (extent > limits.max_extent_m)
      reasons.push_back(fmt::format("control points span {:.3f} m along {}; limit {:.3f} m", extent,
                                    "xyz"[axis], limits.max_extent_m));
  }
  if (stroke.degree == 2 && stroke.control_points_m.size() > 2) {
    const double share = CurveSpeed(stroke, cell.motion) / stroke.speed_mps;
    if (share < limits.min_curve_speed_share)
      reasons.push_back(fmt::format(
          "curve bends so abruptly that it must slow to {:.3f} of its speed; needs {:.3f}", share,
          limits.min_curve_speed_share));
  }
  const double fastest = limits.tcp_speed_mps * limits.share_of_speed;
  if (stroke.speed_mps > fastest)
    reasons.push_back(fmt::format("speed {:.3f} m/s; limit {:.3f} m/s", stroke.speed_mps, fastest));
}

void SafetyGate::Impl::CheckBlade(const ToolPath& path, const HeightMap& terrain,
                                  std::vector<std::string>& reasons) const {
  const MotionLimits& limits = cell.limits;
  const Blade& blade = cell.tool.blade;
  double wall = std::numeric_limits<double>::infinity(), lowest = wall, radius = wall, cut = -wall;
  BladePose wall_at, lowest_at, radius_at, cut_at;
  for (size_t i = 0; i < path.size(); ++i) {
    const BladePose& p = path[i];
    if (i > 0) {
      const double moved = std::hypot(p.x_m - path[i - 1].x_m, p.y_m - path[i - 1].y_m);
      const double turned = std::abs(p.yaw_rad - path[i - 1].yaw_rad);
      // A turn on the spot is a polyline's corner.
      if (moved > 0 && moved < radius * turned) radius = moved / turned, radius_at = p;
    }
    const double c = std::abs(std::cos(p.yaw_rad)), s = std::abs(std::sin(p.yaw_rad));
    const double half_x = 0.5 * (blade.thickness_m * c + blade.width_m * s);
    const double half_y = 0.5 * (blade.thickness_m * s + blade.width_m * c);
    const double distance = std::min({p.x_m - half_x, cell.box.width_m - p.x_m - half_x,
                                      p.y_m - half_y, cell.box.depth_m - p.y_m - half_y});
    if (distance < wall) wall = distance, wall_at = p;
    if (p.z_m < lowest) lowest = p.z_m, lowest_at = p;
    for (int k = -2; k <= 2; ++k) {
      const double across = 0.25 * k * blade.width_m;
      const double sand = HeightAt(terrain, p.x_m - across * std::sin(p.yaw_rad),
                                   p.y_m + across * std::cos(p.yaw_rad));
      if (!std::isfinite(sand)) {
        reasons.push_back("terrain: a height under the blade is not finite, at " + Where(p));
        return;
      }
      if (sand - p.z_m > cut) cut = sand - p.z_m, cut_at = p;
    }
  }
  if (radius < limits.min_bend_radius_m)
    reasons.push_back(fmt::format("curve bends with a radius of {:.1f} mm at {}; needs {:.1f} mm",
                                  radius * 1e3, Where(radius_at), limits.min_bend_radius_m * 1e3));
  if (wall < limits.wall_margin_m)
    reasons.push_back(fmt::format("blade {:.1f} mm {} the box wall at {}; needs {:.1f} mm inside",
                                  std::abs(wall) * 1e3, wall < 0 ? "beyond" : "inside",
                                  Where(wall_at), limits.wall_margin_m * 1e3));
  if (lowest < limits.floor_margin_m)
    reasons.push_back(fmt::format("blade {:.1f} mm {} the box floor at {}; needs {:.1f} mm above",
                                  std::abs(lowest) * 1e3, lowest < 0 ? "below" : "above",
                                  Where(lowest_at), limits.floor_margin_m * 1e3));
  if (cut > limits.max_cut_m)
    reasons.push_back(fmt::format("blade {:.1f} mm deep in the sand at {}; limit {:.1f} mm",
                                  cut * 1e3, Where(cut_at), limits.max_cut_m * 1e3));
}

double SafetyGate::Impl::SandTop(const ToolPath& path, const HeightMap& terrain) const {
  double x0 = 1e9, x1 = -1e9, y0 = 1e9, y1 = -1e9;
  for (const BladePose& p : path) {
    x0 = std::min(x0, p.x_m), x1 = std::max(x1, p.x_m);
    y0 = std::min(y0, p.y_m), y1 = std::max(y1, p.y_m);
  }
  const auto index = [&](double value, int count) {
    return static_cast<int>(std::clamp(value / terrain.cell_size_m, 0.0, count - 1.0));
  };
  const int i0 = index(x0 - kHandReach_m, terrain.columns),
            i1 = index(x1 + kHandReach_m, terrain.columns);
  const int j0 = index(y0 - kHandReach_m, terrain.rows),
            j1 = index(y1 + kHandReach_m, terrain.rows);
  float top = 0;
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) top = std::max(top, terrain.At(j, i));
  return top;
}

// Nearest first, so that the arm changes its configuration only where it must.
std::vector<Candidate> SafetyGate::Impl::Candidates(const BladePose& start,
                                                    const JointAngles& near) const {
  std::vector<Candidate> candidates;
  for (Branch branch = 0; branch < kBranches; ++branch) {
    for (const bool flipped : {false, true}) {
      const auto q = kinematics.Solve(start, branch, flipped, near);
      if (!q) break;
      candidates.push_back({branch, flipped, (q->rad - near.rad).cwiseAbs().maxCoeff()});
    }
  }
  std::ranges::stable_sort(candidates, {}, &Candidate::distance_rad);
  return candidates;
}

void SafetyGate::Impl::LookAt(const JointAngles& q, double sand_top_m, const GateLimits& limits,
                              ClearanceModel::Lease& lease, ArmFigures& figures) const {
  const double singular = SmallestSingularValue(kinematics.arm().Jacobian(q));
  figures.min_singular_value = std::min(figures.min_singular_value, singular);
  const auto nearest = lease.At(q, figures.min_clearance_m);
  if (nearest.distance_m < limits.clearance_m && figures.min_clearance_m >= limits.clearance_m)
    figures.reasons.push_back(fmt::format("{} come within {:.1f} mm or less; needs {:.1f} mm",
                                          nearest.between, nearest.distance_m * 1e3,
                                          limits.clearance_m * 1e3));
  const double above = lease.AboveSand(sand_top_m, figures.min_clearance_m);
  if (above < limits.clearance_m && figures.min_clearance_m >= limits.clearance_m)
    figures.reasons.push_back(
        fmt::format("arm or camera {:.1f} mm above the sand's top or less; needs {:.1f} mm",
                    above * 1e3, limits.clearance_m * 1e3));
  figures.min_clearance_m = std::min({figures.min_clearance_m, nearest.distance_m, above});
}

ArmFigures SafetyGate::Impl::TryCoarse(const std::vector<PathPiece>& pieces,
                                       const Candidate& candidate, const JointAngles& near,
                                       double sand_top_m, ClearanceModel::Lease& lease) const {
  ArmFigures figures(coarse.clearance_m + kCoarseSeen_m);
  JointPeaks peaks;
  const auto fail = [&](const BladePose& pose) {
    figures.reasons.push_back(
        fmt::format("branch {} does not reach {}", candidate.branch, Where(pose)));
    return figures;
  };
  const BladePose start = pieces.front().At(0);
  auto q = kinematics.Solve(start, candidate.branch, candidate.flipped, near);
  if (!q) return fail(start);
  LookAt(*q, sand_top_m, coarse, lease, figures);
  for (const PathPiece& piece : pieces) {
    figures.duration_s += piece.timing.duration_s();
    const bool turn = piece.kind == PathPiece::Kind::kTurn;
    const bool vertical =
        piece.kind == PathPiece::Kind::kDown || piece.kind == PathPiece::Kind::kUp;
    const double step_m = vertical ? kCoarseVerticalStep_m : kCoarseStep_m;
    const double turned = std::abs(piece.poses.back().yaw_rad - piece.poses.front().yaw_rad);
    const int steps = std::max({1, static_cast<int>(std::ceil(turned / kCoarseTurn_rad)),
                                turn ? 1 : static_cast<int>(std::ceil(piece.length() / step_m))});
    const double step = piece.length() / steps, v = piece.timing.speed();
    const double a =
        turn ? cell.motion.turn_acceleration_radps2 : cell.motion.path_acceleration_mps2;
    const double j = 2 * a / cell.motion.smoothing_s;
    Vector6 slope_before;
    for (int k = 1; k <= steps && figures.reasons.empty(); ++k) {
      const BladePose pose = piece.At(k * step);
      const auto next = kinematics.Solve(pose, candidate.branch, candidate.flipped, *q);
      if (!next) return fail(pose);
      // dq/dt = q' s', d2q/dt2 = q' s'' + q'' s'^2 and so on, with differences for q' and q''.
      const Vector6 slope = (next->rad - q->rad) / step;
      const Vector6 bend =
          k > 1 ? Vector6((slope - slope_before) / step) : Vector6(Vector6::Zero());
      JointPeaks::Raise(peaks.position, next->rad);
      JointPeaks::Raise(peaks.speed, slope * v);
      JointPeaks::Raise(peaks.acceleration, slope.cwiseAbs() * a + bend.cwiseAbs() * v * v);
      JointPeaks::Raise(peaks.jerk, slope.cwiseAbs() * j + 3 * bend.cwiseAbs() * v * a);
      slope_before = slope;
      q = next;
      LookAt(*q, sand_top_m, coarse, lease, figures);
    }
  }
  peaks.Report(coarse, figures);
  return figures;
}

ArmFigures SafetyGate::Impl::TryFine(std::span<const JointAngles> knots, double sand_top_m,
                                     ClearanceModel::Lease& lease) const {
  ArmFigures figures(kClearanceSeen_m);
  JointPeaks peaks;
  constexpr double dt = StrokeMotion::kPeriod_s;
  const auto at = [&](std::ptrdiff_t i) -> const Vector6& {  // held before and after
    return knots[static_cast<size_t>(std::clamp<std::ptrdiff_t>(i, 0, std::ssize(knots) - 1))].rad;
  };
  std::ptrdiff_t looked = -1;
  double blade_speed_mps = 0;
  Eigen::Vector3d blade = kinematics.BladeInBox({at(0)}).translation();
  for (std::ptrdiff_t i = 0; i < std::ssize(knots) + 3; ++i) {
    JointPeaks::Raise(peaks.position, at(i));
    JointPeaks::Raise(peaks.speed, (at(i) - at(i - 1)) / dt);
    JointPeaks::Raise(peaks.acceleration, (at(i) - 2 * at(i - 1) + at(i - 2)) / (dt * dt));
    JointPeaks::Raise(peaks.jerk,
                      (at(i) - 3 * at(i - 1) + 3 * at(i - 2) - at(i - 3)) / (dt * dt * dt));
    const Eigen::Vector3d before = blade;
    blade = kinematics.BladeInBox({at(i)}).translation();
    blade_speed_mps = std::max(blade_speed_mps, (blade - before).norm() / dt);
    if (looked < 0 || i == std::ssize(knots) - 1 ||
        (at(i) - at(looked)).cwiseAbs().maxCoeff() > kFineLook_rad) {
      LookAt({at(i)}, sand_top_m, fine, lease, figures);
      looked = i;
    }
  }
  peaks.Report(fine, figures);
  const double fastest_mps = cell.limits.pendant_tcp_speed_mps - MotionLimits::kPendantSpeedTolerance_mps;
  if (blade_speed_mps > fastest_mps)
    figures.reasons.push_back(fmt::format("blade at {:.2f} m/s; the pendant's limit leaves {:.2f} m/s",
                                          blade_speed_mps, fastest_mps));
  figures.duration_s = static_cast<double>(knots.size() - 1) * dt;
  return figures;
}

void SafetyGate::Impl::CheckArm(const Stroke& stroke, double sand_top_m, GateSampling sampling,
                                const JointAngles& near, GateVerdict& verdict) const {
  const bool is_fine = sampling == GateSampling::kFine;
  const auto pieces =
      StrokePieces(stroke, cell.motion, is_fine ? CurveSampling::kFine : CurveSampling::kCoarse);
  const BladePose start = pieces.front().At(0);
  const auto candidates = Candidates(start, near);
  if (candidates.empty()) {
    const Eigen::Vector3d flange = kinematics.FlangePose(start, false).translation();
    verdict.reasons.push_back(fmt::format("out of reach: {}, flange {:.3f} m from the base's axis",
                                          Where(start), flange.head<2>().norm()));
    return;
  }
  ClearanceModel::Lease lease(clearance);
  std::optional<ArmFigures> best;
  for (const Candidate& candidate : candidates) {
    std::optional<StrokeMotion> motion;
    ArmFigures figures(kClearanceSeen_m);
    if (is_fine) {
      motion = MakeStrokeMotion(pieces, kinematics, candidate.branch, candidate.flipped, near);
      if (!motion) continue;
      figures = TryFine(motion->knots, sand_top_m, lease);
    } else {
      figures = TryCoarse(pieces, candidate, near, sand_top_m, lease);
    }
    if (best && figures.reasons.size() >= best->reasons.size()) continue;
    best = figures;
    verdict.branch = candidate.branch;
    verdict.motion = std::move(motion);
    if (figures.reasons.empty()) break;
  }
  if (!best) {
    verdict.reasons.push_back("out of reach: no branch of the arm follows the whole stroke");
    return;
  }
  verdict.reasons.insert(verdict.reasons.end(), best->reasons.begin(), best->reasons.end());
  verdict.duration_s = best->duration_s;
  verdict.peak_joint_speed_share = best->peak_speed_share;
  verdict.min_clearance_m = best->min_clearance_m;
  verdict.min_singular_value =
      std::isfinite(best->min_singular_value) ? best->min_singular_value : 0;
  const double longest = cell.limits.max_duration_s / (is_fine ? 1 : kCoarseDuration);
  if (verdict.duration_s > longest)
    verdict.reasons.push_back(
        fmt::format("takes {:.1f} s; limit {:.1f} s", verdict.duration_s, longest));
}

SafetyGate::SafetyGate(const Workcell& workcell) {
  CheckWorkcell(workcell, "workcell");
  impl_ = std::make_unique<const Impl>(workcell);
}

SafetyGate::~SafetyGate() = default;

const ReachMap& SafetyGate::reach() const {
  std::call_once(impl_->reach_once, [this] { impl_->reach = MeasureReach(*this); });
  return impl_->reach;
}

const Workcell& SafetyGate::workcell() const { return impl_->cell; }
const BladeKinematics& SafetyGate::kinematics() const { return impl_->kinematics; }

GateVerdict SafetyGate::Check(const Stroke& stroke, const HeightMap& terrain, GateSampling sampling,
                              const std::optional<JointAngles>& near) const {
  GateVerdict verdict;
  try {
    CheckStroke(stroke, "stroke");
  } catch (const Error& error) {
    verdict.reasons = {error.what()};
    return verdict;
  }
  impl_->CheckTerrain(terrain, verdict.reasons);
  const bool terrain_fits = verdict.reasons.empty();
  impl_->CheckShape(stroke, verdict.reasons);
  double sand_top_m = 0;
  if (terrain_fits) {
    const ToolPath path = SamplePath(stroke, kFootprintStep_m, kFootprintTurn_rad);
    impl_->CheckBlade(path, terrain, verdict.reasons);
    sand_top_m = impl_->SandTop(path, terrain);
  }
  if (verdict.reasons.empty() || sampling == GateSampling::kFine)
    impl_->CheckArm(stroke, sand_top_m, sampling, near.value_or(impl_->cell.home()), verdict);
  verdict.accepted = verdict.reasons.empty();
  if (!verdict.accepted) verdict.motion.reset();
  return verdict;
}

TransferVerdict SafetyGate::CheckKnots(std::vector<JointAngles> knots, double sand_top_m) const {
  ClearanceModel::Lease lease(impl_->clearance);
  TransferVerdict verdict;
  verdict.reasons = impl_->TryFine(knots, sand_top_m, lease).reasons;
  verdict.accepted = verdict.reasons.empty();
  if (verdict.accepted) verdict.knots = std::move(knots);
  return verdict;
}

TransferVerdict SafetyGate::CheckTransfer(const JointAngles& from, const JointAngles& to,
                                          const HeightMap& terrain) const {
  TransferVerdict verdict;
  impl_->CheckTerrain(terrain, verdict.reasons);
  if (!verdict.reasons.empty()) return verdict;
  return CheckKnots(TransferKnots(from, to, impl_->cell.motion),
                    std::ranges::max(terrain.height_m));
}

}  // namespace sandwright
