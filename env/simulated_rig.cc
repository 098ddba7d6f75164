#include "env/simulated_rig.h"

#include "data/base/error.h"
#include "robot_model/camera_pose.h"

namespace sandwright {
namespace {

constexpr double kStart_rad = 0.02;  // as the programs for a controller demand

}  // namespace

SimulatedRig::SimulatedRig(const Workcell& workcell, const SandModel& world, HeightMap truth,
                           const SimulatedRigConfig& config, RandomStream stream,
                           std::filesystem::path bed_file)
    : cell_(workcell),
      world_(world),
      sand_(world.Start(std::move(truth), stream.Next64())),
      config_(config),
      arm_(workcell, config.arm),
      stream_(stream),
      bed_file_(std::move(bed_file)),
      joints_(workcell.home()) {}

Execution SimulatedRig::Execute(const GatedMotion& motion, const ExecuteOptions& options) {
  if ((joints_.rad - motion.start().rad).cwiseAbs().maxCoeff() > kStart_rad)
    return {.end = "not at start",
            .reason = "the arm is not where the motion begins; nothing was moved"};
  Execution execution{.finished = true, .end = "finished"};
  execution.record = arm_.Follow(motion.knots(), stream_, options.speed_share);
  joints_ = execution.record.measured.back();
  if (motion.kind() != GatedMotion::Kind::kStroke) return execution;
  path_ = ExecutedPath(execution.record, motion.stroke_motion(), motion.knots(),
                       [&](const JointAngles& q) { return arm_.BladeInBox(q); });
  world_.Apply({&sand_, 1}, {&path_, 1});
  if (!bed_file_.empty()) WriteHeightMap(sand_.map(), bed_file_);
  return execution;
}

DepthView SimulatedRig::Look() {
  const Eigen::Isometry3d X_BC = CameraInBox(cell_, joints_);
  const DepthCamera camera(cell_.camera, X_BC,
                           {.wall_height_m = cell_.box.wall_height_m,
                            .wall_thickness_m = cell_.box.wall_thickness_m,
                            .table_m = cell_.box.floor_thickness_m});
  DepthView view{{}, X_BC};
  for (int64_t i = 0; i < config_.frames; ++i)
    view.frames.push_back(camera.Render(sand_.map(), stream_));
  return view;
}

}  // namespace sandwright
