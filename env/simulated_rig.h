// A rig without hardware: the MuJoCo arm, a sand model as the world, a depth camera on the flange.
#pragma once

#include <filesystem>

#include "data/base/random.h"
#include "env/depth_camera.h"
#include "env/sand_model.h"
#include "env/simulated_arm.h"
#include "robot_model/rig.h"
#include "robot_model/workcell.h"

namespace sandwright {

struct SimulatedRigConfig {
  int64_t frames = 4;  // of a look
  SimulatedArmConfig arm;

  void Fields(FieldList& f) {
    f.Add("frames", frames, "depth frames of a look", 1, 100);
    f.Section("arm", arm);
  }
};

// Holds the true state of the bed, which only its camera shows.
class SimulatedRig final : public Rig {
 public:
  // `world` must outlive the rig; `truth` covers the workcell's box, datum floor. The arm begins at
  // home. With a `bed_file` the bed is kept there after each stroke, as a real one outlives the program.
  SimulatedRig(const Workcell& workcell, const SandModel& world, HeightMap truth,
               const SimulatedRigConfig& config, RandomStream stream,
               std::filesystem::path bed_file = {});

  std::string name() const override { return "simulated"; }
  JointAngles Joints() override { return joints_; }
  // The arm follows the motion and the sand gives way to where the blade really went.
  Execution Execute(const GatedMotion& motion, const ExecuteOptions& options = {}) override;
  // The camera's pose is the one that the workcell's kinematics give for the joints.
  DepthView Look() override;

  const HeightMap& truth() const { return sand_.map(); }
  // Where the blade went in the last stroke; empty before.
  const ToolPath& last_path() const { return path_; }

 private:
  Workcell cell_;
  const SandModel& world_;
  SandState sand_;
  SimulatedRigConfig config_;
  SimulatedArm arm_;
  RandomStream stream_;
  std::filesystem::path bed_file_;
  JointAngles joints_;
  ToolPath path_;
};

}  // namespace sandwright
