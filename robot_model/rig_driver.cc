#include "robot_model/rig_driver.h"

#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <limits>

#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr double kThere_rad = 0.002;    // nearer than this to a pose, the arm need not move
constexpr double kAtRetreat_m = 0.005;  // how much lower than the retreat height a blade may hang

// The arm may trail the motion in time.
double Deviation_rad(const ArmRecord& record, const std::vector<JointAngles>& knots) {
  const std::vector<size_t> progress = Progress(record, knots);
  double furthest = 0;
  for (size_t i = 0; i < record.size(); ++i)
    furthest = std::max(
        furthest, (record.measured[i].rad - knots[progress[i]].rad).cwiseAbs().maxCoeff());
  return furthest;
}

}  // namespace

std::string Drive::why() const {
  if (!refused.empty()) return fmt::format("the gate refused: {}", fmt::join(refused, "; "));
  if (!execution || execution->finished) return "";
  return execution->end + ": " + execution->reason;
}

Drive RigDriver::Execute(const Passage& passage, const ExecuteOptions& options) {
  Drive drive{.refused = passage.reasons};
  if (!passage.motion) return drive;
  const GatedMotion& motion = *passage.motion;
  drive.execution = rig_.Execute(motion, options);
  const ArmRecord& record = drive.execution->record;
  drive.deviation_rad = Deviation_rad(record, motion.knots());
  if (motion.kind() == GatedMotion::Kind::kStroke)
    drive.path =
        ExecutedPath(record, motion.stroke_motion(), motion.knots(),
                     [&](const JointAngles& q) { return gate_.kinematics().BladeInBox(q); });
  return drive;
}

Drive RigDriver::ToCamera() { return ToPose(gate_.workcell().camera_pose()); }

Drive RigDriver::ToPose(const JointAngles& to) {
  const JointAngles from = rig_.Joints();
  const double below_m = gate_.workcell().motion.retreat_height_m -
                         gate_.kinematics().BladeInBox(from).translation().z();
  if (below_m > kAtRetreat_m)
    return {.refused = {
                fmt::format("the blade stands {:.0f} mm below the retreat height: recover first",
                            1e3 * below_m)}};
  if ((to.rad - from.rad).cwiseAbs().maxCoeff() < kThere_rad)
    return {.execution = Execution{.finished = true, .end = "finished"}};
  return Execute(
      latest_ ? gate_.PassTransfer(to, *latest_, from) : gate_.PassUnseenTransfer(to, from), {});
}

RigDriver::Seen RigDriver::Look() {
  Seen seen;
  std::vector<DepthView> views;
  for (const JointAngles& pose : gate_.workcell().camera_poses()) {
    seen.drive = ToPose(pose);
    if (!seen.drive.finished()) return seen;
    try {
      views.push_back(rig_.Look());
    } catch (const Error& error) {
      if (error.kind() == ErrorKind::kInterrupted) throw;
      seen.scan.reasons = {error.what()};
      return seen;
    }
  }
  const BoxSettings& box = gate_.workcell().box;
  seen.scan = ScanViews(views, gate_.workcell().camera, scan_, {box.width_m, box.depth_m});
  if (seen.scan.accepted) latest_ = seen.scan.map;
  return seen;
}

Drive RigDriver::Run(const Stroke& stroke, const ExecuteOptions& options) {
  if (!latest_) return {.refused = {"the bed has not been seen"}};
  return Execute(gate_.PassStroke(stroke, *latest_, rig_.Joints()), options);
}

Drive RigDriver::RunLifted(const Stroke& stroke, double clearance_m,
                           const ExecuteOptions& options) {
  if (!latest_) return {.refused = {"the bed has not been seen"}};
  double lowest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& p : stroke.control_points_m) lowest = std::min(lowest, p.z());
  Stroke lifted = stroke;
  for (Eigen::Vector3d& p : lifted.control_points_m)
    p.z() += std::ranges::max(latest_->height_m) + clearance_m - lowest;
  return Run(lifted, options);
}

Drive RigDriver::Lift() { return Execute(gate_.PassLift(rig_.Joints()), {}); }

}  // namespace sandwright
