// The arm of a simulated rig: follows joint motion as a servo does, a little late and a little off.
#pragma once

#include <vector>

#include "data/base/random.h"
#include "robot_model/arm_model.h"
#include "robot_model/arm_record.h"
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

class SimulatedArm {
 public:
  explicit SimulatedArm(const Workcell& workcell, const SimulatedArmConfig& config = {});

  // Follows the knots (StrokeMotion::kPeriod_s apart) at a share of their speed, then waits until
  // the lag is gone.
  ArmRecord Follow(const std::vector<JointAngles>& knots, RandomStream& random,
                   double speed_share = 1) const;
  // X_BT, by MuJoCo's kinematics.
  Eigen::Isometry3d BladeInBox(const JointAngles& q) const;

 private:
  SimulatedArmConfig config_;
  Eigen::Isometry3d X_BW_;
  MujocoModel model_;
  MujocoData data_;
};

}  // namespace sandwright
