// Shaped beds under a camera somewhere above them, with the truth of where their box is.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include "data/base/random.h"
#include "data/scan.h"
#include "env/avalanche.h"
#include "env/depth_camera.h"
#include "env/terrain_generator.h"

namespace sandwright {

// What was done to the sand; all of it reaches the walls, and all slopes are at most 33 degrees.
inline constexpr std::array<std::string_view, 6> kBedKinds = {
    "dunes", "large dunes", "furrows", "trench along a wall", "heap against a wall", "level"};

struct SimulatedBed {
  HeightMap sand;
  Eigen::Isometry3d X_BC = Eigen::Isometry3d::Identity();
  DepthFrame frame;
};

struct BedView {
  double max_tilt_deg = 6;   // of the camera, about any level axis
  bool any_heading = false;  // the box turned in the picture by any angle, otherwise by 12 degrees
  DepthCameraConfig camera;
};

// Lowers (depth > 0) or raises the sand along a line across the bed with flanks of 33 degrees.
inline void AddRidge(HeightMap& sand, double x_m, double y_m, double heading_rad, double height_m,
                     double flat_m) {
  const double repose = std::tan(33 * std::numbers::pi / 180);
  for (int j = 0; j < sand.rows; ++j) {
    for (int i = 0; i < sand.columns; ++i) {
      const double x = (i + 0.5) * sand.cell_size_m - x_m, y = (j + 0.5) * sand.cell_size_m - y_m;
      const double away = std::abs(std::cos(heading_rad) * y - std::sin(heading_rad) * x);
      const double rise = std::max(0.0, std::abs(height_m) - repose * std::max(0.0, away - flat_m));
      sand.At(j, i) =
          std::max(0.0f, sand.At(j, i) + static_cast<float>(std::copysign(rise, height_m)));
    }
  }
}

inline HeightMap DrawSand(std::string_view kind, double width_m, double depth_m,
                          RandomStream& random) {
  constexpr double kCell_m = 0.004;
  const bool large = kind == "large dunes";
  TerrainConfig terrain;
  terrain.mean_depth_m = large ? 0.08 : 0.06;
  terrain.amplitude_m = kind == "level" ? 0.002 : large ? 0.022 : 0.008;
  terrain.longest_m = (large ? 0.4 : 0.25) * std::min(1.0, depth_m / 0.8);
  HeightMap sand =
      GenerateTerrain(terrain, static_cast<int>(std::lround(depth_m / kCell_m)),
                      static_cast<int>(std::lround(width_m / kCell_m)), kCell_m, random);
  const double turn = std::numbers::pi / 2;
  if (kind == "furrows") {
    for (int i = 0; i < 6; ++i)
      AddRidge(
          sand, random.Uniform(0, width_m), random.Uniform(0, depth_m),
          random.Uniform() < 0.5 ? turn * (random.Uniform() < 0.5) : random.Uniform(0, 2 * turn),
          random.Uniform() < 0.5 ? -0.03 : 0.02, random.Uniform(0, 0.025));
  } else if (kind == "trench along a wall" || kind == "heap against a wall") {
    const bool heap = kind.front() == 'h';
    const double away = heap ? 0 : random.Uniform(0.01, 0.08);
    const double height = heap ? random.Uniform(0.03, 0.06) : -random.Uniform(0.02, 0.04);
    if (random.Uniform() < 0.5)
      AddRidge(sand, 0, random.Uniform() < 0.5 ? away : depth_m - away, 0, height, 0);
    else
      AddRidge(sand, random.Uniform() < 0.5 ? away : width_m - away, 0, turn, height, 0);
  }
  RelaxToRepose(sand, terrain.repose_deg);
  return sand;
}

// Whether the camera sees all of the walls' rim, three pixels from the picture's edge.
inline bool SeesBox(const CameraModel& camera, const Eigen::Isometry3d& X_BC, double width_m,
                    double depth_m, double rim_m) {
  for (double x : {-0.02, width_m + 0.02}) {
    for (double y : {-0.02, depth_m + 0.02}) {
      const Eigen::Vector3d p = X_BC.inverse() * Eigen::Vector3d(x, y, rim_m);
      const double u = camera.fx_px * p.x() / p.z() + camera.cx_px,
                   v = camera.fy_px * p.y() / p.z() + camera.cy_px;
      if (u < 3 || v < 3 || u > static_cast<double>(camera.width) - 4 ||
          v > static_cast<double>(camera.height) - 4)
        return false;
    }
  }
  return true;
}

// A bed of 1200 x 800 mm (`large_box`) or 300 x 300 mm, its walls 20 to 80 mm above the highest
// sand, under a camera that sees all of it from 1.15 to 1.6 m or 0.5 to 1.2 m above the floor.
inline SimulatedBed DrawBed(std::string_view kind, bool large_box, uint64_t seed,
                            const BedView& view = {}, const CameraModel& camera = {}) {
  const double width_m = large_box ? 1.2 : 0.3, depth_m = large_box ? 0.8 : 0.3;
  RandomStream random(seed, StreamId(kind), large_box);
  SimulatedBed bed{DrawSand(kind, width_m, depth_m, random), {}, {}};
  DepthCameraConfig scene = view.camera;
  scene.wall_height_m = std::ranges::max(bed.sand.height_m) + random.Uniform(0.02, 0.08);
  do {
    const double height = large_box ? random.Uniform(1.15, 1.6) : random.Uniform(0.5, 1.2);
    bed.X_BC = CameraAbove(width_m, depth_m, height);
    const double heading = view.any_heading ? random.Uniform(-180, 180) : random.Uniform(-12, 12);
    const double tilt = random.Uniform(0, view.max_tilt_deg),
                 axis = random.Uniform(0, 2 * std::numbers::pi);
    const double degree = std::numbers::pi / 180;
    // The camera swings about the middle of the box, and looks a little beside it.
    const Eigen::Vector3d middle(width_m / 2 + random.Uniform(-0.03, 0.03),
                                 depth_m / 2 + random.Uniform(-0.03, 0.03), 0);
    const Eigen::Matrix3d swing =
        Eigen::AngleAxisd(tilt * degree, Eigen::Vector3d(std::cos(axis), std::sin(axis), 0))
            .toRotationMatrix();
    bed.X_BC.linear() =
        swing * bed.X_BC.linear() * Eigen::AngleAxisd(heading * degree, Eigen::Vector3d::UnitZ());
    bed.X_BC.translation() = middle + swing * Eigen::Vector3d(0, 0, height);
  } while (!SeesBox(camera, bed.X_BC, width_m, depth_m, scene.wall_height_m));
  bed.frame = DepthCamera(camera, bed.X_BC, scene).Render(bed.sand, random);
  return bed;
}

// Lays a round bar of `radius_m` from `from_B` to `to_B` over the scene: a forearm.
inline void AddForearm(const CameraModel& camera, const Eigen::Isometry3d& X_BC,
                       const Eigen::Vector3d& from_B, const Eigen::Vector3d& to_B, double radius_m,
                       DepthFrame& frame) {
  const Eigen::Vector3d from = X_BC.inverse() * from_B, to = X_BC.inverse() * to_B;
  // As balls: a tenth of their radius apart they differ from the bar by an eighth of a percent of
  // it.
  const int balls = 1 + static_cast<int>((to - from).norm() / (0.1 * radius_m));
  const std::vector<PixelRay> rays = PixelRays(camera);
  for (size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector3d ray(rays[i].x, rays[i].y, 1);
    for (int k = 0; k <= balls; ++k) {
      const Eigen::Vector3d middle = from + (to - from) * k / balls;
      // |t ray - middle| = radius.
      const double a = ray.squaredNorm(), b = ray.dot(middle),
                   c = middle.squaredNorm() - radius_m * radius_m;
      if (b * b < a * c) continue;
      const auto depth = static_cast<float>((b - std::sqrt(b * b - a * c)) / a);
      if (frame.depth_m[i] == 0 || depth < frame.depth_m[i]) frame.depth_m[i] = depth;
    }
  }
}

// The largest distance in plan between a corner that was found and the true corner nearest to it.
inline double WorstCorner(const SimulatedBed& bed,
                          const std::array<Eigen::Vector3d, 4>& corners_C) {
  double worst = 0;
  for (double x : {0.0, bed.sand.width_m()}) {
    for (double y : {0.0, bed.sand.depth_m()}) {
      double nearest = std::numeric_limits<double>::infinity();
      for (const Eigen::Vector3d& corner_C : corners_C)
        nearest =
            std::min(nearest, ((bed.X_BC * corner_C).head<2>() - Eigen::Vector2d(x, y)).norm());
      worst = std::max(worst, nearest);
    }
  }
  return worst;
}

}  // namespace sandwright
