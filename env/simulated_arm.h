// The arm of a simulated rig: follows joint motion as a servo does, a little late and a little off.
#pragma once

#include <vector>

#include "data/base/random.h"
#include "data/stroke.h"
#include "robot_model/arm_model.h"
#include "robot_model/stroke_motion.h"
#include "robot_model/workcell.h"

namespace sandwright {

// Size of the errors: with the defaults the blade of the shipped cell trails a 0.1 m/s stroke by 2
// mm along it and strays from it by about 0.1 mm.
struct SimulatedArmConfig {
  double servo_lag_s = 0.020;  // of each joint behind its command, first order
  double wander_rad = 5e-5;    // standard deviation of a slow error of each joint
  double wander_time_s = 0.3;  // over which that error changes

  void Fields(FieldList& f) {
    f.Add("servo_lag_s", servo_lag_s, "lag of each joint behind its command [s]", 0, 1);
    f.Add("wander_rad", wander_rad, "standard deviation of a slow joint error [rad]", 0, 0.1);
    f.Add("wander_time_s", wander_time_s, "time over which that error changes [s]", 0.01, 100);
  }
};

// What the arm did, at 125 Hz. One entry a period in each list.
struct ArmRecord {
  std::vector<double> time_s;
  std::vector<JointAngles> commanded, measured;
  std::vector<Vector6> speed_radps;  // of the measured angles

  size_t size() const { return time_s.size(); }
};

struct ExecutedStroke {
  ToolPath path;  // of the blade in the sand, frame B; at most 1 mm and 0.05 rad between poses
  ArmRecord record;
};

class SimulatedArm {
 public:
  explicit SimulatedArm(const Workcell& workcell, const SimulatedArmConfig& config = {});

  // Follows the knots (StrokeMotion::kPeriod_s apart), then waits until the lag is gone.
  ArmRecord Follow(const std::vector<JointAngles>& knots, RandomStream& random) const;
  // A whole stroke; the blade's path comes from MuJoCo's kinematics of the measured angles.
  ExecutedStroke Execute(const StrokeMotion& motion, RandomStream& random) const;

 private:
  SimulatedArmConfig config_;
  Eigen::Isometry3d X_BW_;
  MujocoModel model_;
};

}  // namespace sandwright
