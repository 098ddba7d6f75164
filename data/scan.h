// The scan: depth frames, or an array of heights, to a height map of the sand alone, or a refusal.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/base/config.h"
#include "data/box_finder.h"
#include "data/camera.h"
#include "data/depth_frame.h"
#include "data/height_map.h"
#include "data/npy.h"
#include "data/sand_check.h"

namespace sandwright {

struct ScanConfig {
  double cell_size_m = 0.005;
  std::string level = "sand";
  std::string heights_positive = "up";
  double max_tilt_deg = 20;
  double max_invalid_share = 0.4;
  double max_interpolated_share = 0.1;
  double max_hole_m = 0.04;
  double corner_margin_m = 0.03;
  double max_registration_m = 0.02;
  BoxFinderConfig box;
  SandCheckConfig sand;

  void Fields(FieldList& f) {
    f.Add("cell_size_m", cell_size_m, "cell of the height map; of a height array: its own [m]", 0.0005, 0.1);
    f.Add("level", level, "what is made level: the walls' rim, the sand's plane, nothing",
          {"rim", "sand", "none"});
    f.Add("heights_positive", heights_positive,
          "height arrays: larger numbers are higher (up) or further from the camera (down)", {"up", "down"});
    f.Add("max_tilt_deg", max_tilt_deg, "largest tilt that levelling may remove [deg]", 0, 45);
    f.Add("max_invalid_share", max_invalid_share, "largest share of the box without a reading [-]", 0, 1);
    f.Add("max_interpolated_share", max_interpolated_share, "largest share of cells interpolated [-]", 0, 1);
    f.Add("max_hole_m", max_hole_m, "furthest that an interpolated cell may lie from a seen one [m]", 0, 1);
    f.Add("corner_margin_m", corner_margin_m,
          "readings this close to a corner show posts and tags and are left out [m]", 0, 0.2);
    f.Add("max_registration_m", max_registration_m,
          "furthest that a wall's corner may lie from where the given pose puts it [m]", 0.001, 1);
    f.Section("box", box);
    f.Section("sand", sand);
  }
};

// What is known of the place. Heights are absolute (datum "floor") only where the camera's pose or
// the sand's mean depth is known: the floor itself lies under the sand.
struct ScanPlace {
  std::optional<Eigen::Vector2d> box_size_m = std::nullopt;  // inner width (x) and depth (y); x the longer where no pose is given
  std::optional<Eigen::Isometry3d> X_BC = std::nullopt;      // the camera in the box; needs box_size_m
  std::optional<double> sand_depth_m = std::nullopt;         // mean height of the sand above the floor
};

struct ScanResult {
  bool accepted = false;
  std::vector<std::string> reasons;   // of the refusal, each with its figure and limit
  std::vector<std::string> warnings;
  HeightMap map;                      // empty where the box was not found
  double invalid_share = 0;           // pixels in the box (cells of an array) without a reading
  double interpolated_share = 0;      // cells that were interpolated (0 in map.valid)
  double tilt_removed_deg = 0;        // against the optical axis, or against the array's zero plane
  double noise_mm = 0;                // single reading on sand, standard deviation
  double seconds = 0;
  std::optional<double> registration_error_m;  // worst corner, where the pose was given
  std::array<Eigen::Vector3d, 4> corners_C{};  // inner corners (0,0) (w,0) (w,d) (0,d) on the sand, in C
};

// Frame B is the given pose's; found, it has its origin at the corner from which the longer side runs
// to the right of the picture (downwards where it is upright) and z points at the camera.
// Throws Error for frames of the wrong size, without a reading, or contradictory input; a scene that
// is not sand in a box is no error but a refusal.
ScanResult ScanDepth(std::span<const DepthFrame> frames, const CameraModel& camera,
                     const ScanConfig& config, const ScanPlace& given = {});

// What a camera saw from one known pose.
struct DepthView {
  std::vector<DepthFrame> frames;  // of the still scene
  Eigen::Isometry3d X_BC;
};

// The same from several poses, for boxes that none of them sees whole: all readings on one map. Shares
// and noise are those of the worst view.
ScanResult ScanViews(std::span<const DepthView> views, const CameraModel& camera, const ScanConfig& config,
                     const Eigen::Vector2d& box_size_m);

// `heights`: rank 2, rows along y, in units of `unit_m` metres; NaN = not seen. Row j, column i of the
// array is row j, column i of the map. The walls are not in it: level "rim" is an Error.
ScanResult ScanHeights(const NpyArray& heights, double unit_m, const ScanConfig& config,
                       const std::optional<double>& sand_depth_m = std::nullopt);

}  // namespace sandwright
