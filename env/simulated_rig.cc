#include "env/simulated_rig.h"

namespace sandwright {

SimulatedRig::SimulatedRig(const Workcell& workcell, const SandModel& world, HeightMap truth,
                           const SimulatedRigConfig& config, RandomStream stream)
    : world_(world),
      sand_(std::move(truth)),
      config_(config),
      arm_(workcell, config.arm),
      X_BC_(CameraAbove(sand_.map().width_m(), sand_.map().depth_m(), config.camera_height_m)),
      stream_(stream) {}

HeightMap SimulatedRig::Scan(const ScanConfig& config) {
  const HeightMap& bed = sand_.map();
  const DepthCamera camera(config_.camera, X_BC_);
  std::vector<DepthFrame> frames;
  for (int64_t i = 0; i < config_.frames; ++i) frames.push_back(camera.Render(bed, stream_));
  const ScanResult scan =
      ScanDepth(frames, config_.camera, config,
                {.box_size_m = Eigen::Vector2d(bed.width_m(), bed.depth_m()), .X_BC = X_BC_});
  if (!scan.accepted) throw Error("the rescan was refused", scan.reasons);
  return scan.map;
}

ExecutedStroke SimulatedRig::Execute(const StrokeMotion& motion) {
  ExecutedStroke executed = arm_.Execute(motion, stream_);
  world_.Apply({&sand_, 1}, {&executed.path, 1});
  return executed;
}

}  // namespace sandwright
