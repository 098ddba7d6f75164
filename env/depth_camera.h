// What a depth camera sees of a bed of sand: the other end of data/scan.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "data/base/config.h"
#include "data/base/random.h"
#include "data/camera.h"
#include "data/depth_frame.h"
#include "data/height_map.h"

namespace sandwright {

// The box around the sand, the table under it, and the sensor's faults. Not modelled: light that
// bounces between bright sand and the walls, which on a real Kinect bends the walls outwards.
struct DepthCameraConfig {
  double wall_height_m = 0.150;
  double wall_thickness_m = 0.018;
  double table_m = 0.018;
  double noise_m = 0.0006;
  double resolution_m = 0.001;
  double dropout_share = 0.003;
  double edge_dropout_share = 0.4;
  double wall_dropout_share = 0.05;

  void Fields(FieldList& f) {
    f.Add("wall_height_m", wall_height_m, "top of the walls above the box floor [m]", 0.001, 2);
    f.Add("wall_thickness_m", wall_thickness_m, "[m]", 0.001, 0.5);
    f.Add("table_m", table_m, "table below the box floor [m]", 0, 2);
    f.Add("noise_m", noise_m,
          "standard deviation of a reading at 1.2 m; grows with the square of depth [m]", 0, 0.1);
    f.Add("resolution_m", resolution_m, "readings are whole multiples of this [m]", 0.0001, 0.1);
    f.Add("dropout_share", dropout_share, "pixels without a reading, anywhere [-]", 0, 1);
    f.Add("edge_dropout_share", edge_dropout_share, "the same beside jumps of more than 30 mm [-]",
          0, 1);
    f.Add("wall_dropout_share", wall_dropout_share, "the same on the walls' faces [-]", 0, 1);
  }
};

// Pose of a camera straight above the middle of a box, `height_m` above its floor, its picture's
// right along x of B and its picture's top along y.
Eigen::Isometry3d CameraAbove(double width_m, double depth_m, double height_m);

class DepthCamera {
 public:
  // `X_BC`: the camera in the box, above the walls.
  DepthCamera(const CameraModel& camera, const Eigen::Isometry3d& X_BC,
              const DepthCameraConfig& config = {});

  // One frame of `bed` (datum floor; its edges are the inner faces of the walls), as the sensor
  // delivers it: noisy, in whole steps, with holes. One draw is taken from `stream`.
  // Throws Error where the camera is not above the walls or the bed holds a NaN.
  DepthFrame Render(const HeightMap& bed, RandomStream& stream) const;

 private:
  CameraModel camera_;
  Eigen::Isometry3d X_BC_;
  DepthCameraConfig config_;
  std::vector<PixelRay> rays_;
};

}  // namespace sandwright
