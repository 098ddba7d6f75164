// A rig without hardware: the MuJoCo arm, a sand model as the world, a depth camera above the box.
#pragma once

#include "data/base/random.h"
#include "data/scan.h"
#include "env/depth_camera.h"
#include "env/sand_model.h"
#include "env/simulated_arm.h"

namespace sandwright {

struct SimulatedRigConfig {
  double camera_height_m = 1.20;  // straight above the middle of the box
  int64_t frames = 4;             // fused for a scan
  CameraModel camera;
  SimulatedArmConfig arm;

  void Fields(FieldList& f) {
    f.Add("camera_height_m", camera_height_m, "camera above the box floor, over its middle [m]",
          0.5, 4);
    f.Add("frames", frames, "depth frames that one scan fuses", 1, 100);
    f.Section("camera", camera);
    f.Section("arm", arm);
  }
};

// Holds the true state of the bed, which only its camera shows.
class SimulatedRig {
 public:
  // `world` must outlive the rig; `truth` covers the workcell's box, datum floor.
  SimulatedRig(const Workcell& workcell, const SandModel& world, HeightMap truth,
               const SimulatedRigConfig& config, RandomStream stream);

  // Looks at the bed with the camera's known pose. Throws Error
  // (kRefused) where the scan is refused.
  HeightMap Scan(const ScanConfig& config);
  // The arm follows the motion and the sand gives way to where the blade really went.
  ExecutedStroke Execute(const StrokeMotion& motion);

  const HeightMap& truth() const { return sand_.map(); }

 private:
  const SandModel& world_;
  SandState sand_;
  SimulatedRigConfig config_;
  SimulatedArm arm_;
  Eigen::Isometry3d X_BC_;
  RandomStream stream_;
};

}  // namespace sandwright
