#include "robot_model/camera_pose.h"

namespace sandwright {

Eigen::Isometry3d CameraInBox(const Workcell& workcell, const JointAngles& q) {
  return workcell.X_WB.ToIsometry().inverse() * Ur10(workcell.kinematics).Forward(q) *
         workcell.tool.X_FC.ToIsometry();
}

}  // namespace sandwright
