#include "tests/support/controller_fake/controller_state.h"

namespace sandwright::fake {

Eigen::Vector3d RotationVector(const Eigen::Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

Vector6 PoseVector(const Eigen::Isometry3d& X) {
  Vector6 pose;
  pose << X.translation(), RotationVector(X.linear());
  return pose;
}

Eigen::Isometry3d PoseFromVector(const Vector6& pose) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = pose.head<3>();
  const double angle = pose.tail<3>().norm();
  if (angle > 0)
    X.linear() = Eigen::AngleAxisd(angle, pose.tail<3>() / angle).toRotationMatrix();
  return X;
}

}  // namespace sandwright::fake
