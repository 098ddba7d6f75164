// The motions that an arm may execute: SafetyGate's only ways to a GatedMotion.
#include <spdlog/fmt/fmt.h>

#include <limits>

#include "robot_model/rest_to_rest.h"
#include "robot_model/safety_gate.h"

namespace sandwright {
namespace {

constexpr double kLiftAcceleration_mps2 = 0.1;
// Joint angles that are read back and those of a branch's closed form are nearer than this.
constexpr double kSameBranch_rad = 1e-4;

}  // namespace

Passage SafetyGate::PassStroke(const Stroke& stroke, const HeightMap& terrain,
                               const JointAngles& from) const {
  const GateVerdict verdict = Check(stroke, terrain, GateSampling::kFine, from);
  if (!verdict.accepted) return {std::nullopt, verdict.reasons};
  const StrokeMotion& motion = verdict.motion.value();
  TransferVerdict transfer = CheckTransfer(from, motion.knots.front(), terrain);
  for (std::string& reason : transfer.reasons) reason = "transfer to the stroke: " + reason;
  if (!transfer.accepted) return {std::nullopt, std::move(transfer.reasons)};
  GatedMotion gated(GatedMotion::Kind::kStroke, std::move(transfer.knots));
  gated.knots_.pop_back();  // where the stroke's own motion begins
  gated.knots_.insert(gated.knots_.end(), motion.knots.begin(), motion.knots.end());
  gated.stroke_ = stroke;
  gated.motion_ = motion;
  return {std::move(gated), {}};
}

Passage SafetyGate::PassTransfer(const JointAngles& to, const HeightMap& terrain,
                                 const JointAngles& from) const {
  TransferVerdict verdict = CheckTransfer(from, to, terrain);
  if (!verdict.accepted) return {std::nullopt, std::move(verdict.reasons)};
  return {GatedMotion(GatedMotion::Kind::kTransfer, std::move(verdict.knots)), {}};
}

Passage SafetyGate::PassUnseenTransfer(const JointAngles& to, const JointAngles& from) const {
  TransferVerdict verdict =
      CheckKnots(TransferKnots(from, to, workcell().motion), workcell().box.wall_height_m);
  if (!verdict.accepted) return {std::nullopt, std::move(verdict.reasons)};
  return {GatedMotion(GatedMotion::Kind::kTransfer, std::move(verdict.knots)), {}};
}

Passage SafetyGate::PassLift(const JointAngles& from) const {
  const Ur10& arm = kinematics().arm();
  const Eigen::Isometry3d X_WF = arm.Forward(from);
  const Eigen::Vector3d up = workcell().X_WB.ToIsometry().linear().col(2);
  const double rise_m =
      workcell().motion.retreat_height_m - kinematics().BladeInBox(from).translation().z();
  if (rise_m < 1e-6)
    return {std::nullopt,
            {fmt::format("nothing to lift: the blade is {:.1f} mm above the retreat height",
                         -rise_m * 1e3)}};
  const auto branches = arm.Inverse(X_WF, from[5]);
  const auto own = std::ranges::find_if(branches, [&](const IkSolution& s) {
    return (NearestTurns(s.q, from).rad - from.rad).cwiseAbs().maxCoeff() < kSameBranch_rad;
  });
  if (own == branches.end()) return {std::nullopt, {"the arm stands at a singularity"}};
  const RestToRest timing(rise_m, kLiftSpeed_mps, kLiftAcceleration_mps2,
                          workcell().motion.smoothing_s);
  std::vector<JointAngles> knots = {from};
  for (double t = StrokeMotion::kPeriod_s; t < timing.duration_s() + StrokeMotion::kPeriod_s;
       t += StrokeMotion::kPeriod_s) {
    Eigen::Isometry3d X = X_WF;
    X.translation() += timing.At(t) * up;
    const auto next = arm.Inverse(X, own->branch, knots.back()[5]);
    if (!next)
      return {std::nullopt,
              {fmt::format("out of reach {:.1f} mm above where the blade stands",
                           timing.At(t) * 1e3)}};
    knots.push_back(NearestTurns(next->q, knots.back()));
  }
  TransferVerdict verdict = CheckKnots(std::move(knots), std::numeric_limits<double>::lowest());
  if (!verdict.accepted) return {std::nullopt, std::move(verdict.reasons)};
  return {GatedMotion(GatedMotion::Kind::kLift, std::move(verdict.knots)), {}};
}

}  // namespace sandwright
