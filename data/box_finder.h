// Finds the sand box in a depth frame: the rectangle of sand that walls enclose.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "data/base/config.h"
#include "data/box_side.h"
#include "data/camera.h"
#include "data/point_cloud.h"

namespace sandwright {

struct BoxFinderConfig {
  double wall_slope = 0.75;       // 37 degrees on average along a whole side: no dry sand stands so
  double min_wall_support = 0.6;
  double min_wall_rise_m = 0.010;
  double max_wall_rise_m = 0.4;
  double max_skew_deg = 3;
  double min_side_m = 0.15;

  void Fields(FieldList& f) {
    f.Add("wall_slope", wall_slope, "a wall is where the surface is steeper than this along a whole side [m/m]", 0.6, 10);
    f.Add("min_wall_support", min_wall_support,
          "share of each side's length on which the wall must be met, on one line [-]", 0.3, 1);
    f.Add("min_wall_rise_m", min_wall_rise_m, "height of the walls above the sand beside them [m]",
          0.005, 1);
    f.Add("max_wall_rise_m", max_wall_rise_m,
          "an edge that rises further is an arm over the box [m]", 0.05, 5);
    f.Add("max_skew_deg", max_skew_deg, "largest angle between a side and the rectangle [deg]", 0.1, 10);
    f.Add("min_side_m", min_side_m, "shortest side of a box [m]", 0.05, 5);
  }
};

// The box in level coordinates around its own vertical. X_CB maps frame B's axes and origin (a
// corner, at the height of the sand beside the walls) into the camera's frame; x runs along
// `width_m` (the longer side), towards the right of the picture (downwards where it is upright); z is up.
struct FoundBox {
  Eigen::Isometry3d X_CB = Eigen::Isometry3d::Identity();
  double width_m = 0, depth_m = 0;
  std::array<BoxSide, 4> sides;  // x = 0, x = width, y = 0, y = depth

  // (0, 0), (width, 0), (width, depth), (0, depth) in C.
  std::array<Eigen::Vector3d, 4> corners_C() const;
};

// What was found, and why it is not a box of sand where `reasons` is not empty.
struct BoxSearch {
  std::optional<FoundBox> box;
  std::vector<std::string> reasons;
};

// `cloud`: points in C of a frame whose edges were kept (MedianFiltered). `known_up_C`: the
// vertical where the camera's pose is known; otherwise the optical axis to begin with, within 15
// degrees, and then the normal of the walls' rim. `known_size_m`: inner width and depth (longer
// first) where the user gave them; the found box must agree within 2 % + 10 mm and then takes that
// size.
//
// Method: a rectangle grows over the sand until lines stop it that are steep along all of their
// length; scan lines across each side then place it, and the walls' rim gives the vertical for the
// next round.
BoxSearch FindBox(const PointCloud& cloud, const CameraModel& camera,
                  const std::optional<Eigen::Vector3d>& known_up_C, const BoxFinderConfig& config,
                  const std::optional<Eigen::Vector2d>& known_size_m = std::nullopt);

}  // namespace sandwright
