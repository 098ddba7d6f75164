// Where the camera on the flange is.
#pragma once

#include <Eigen/Geometry>

#include "robot_model/workcell.h"

namespace sandwright {

// X_BC at the joint angles, by the cell's kinematics.
Eigen::Isometry3d CameraInBox(const Workcell& workcell, const JointAngles& q);

}  // namespace sandwright
