// The inner corners of the real box as the corner tags show them in the infrared frame of the sensor
// that took the depth frames.
#pragma once

#include <Eigen/Core>
#include <array>

namespace sandwright {

// Where the corners meet the sand, in the camera's plane x, y [m], in the order of
// ScanResult::corners_C. The four ArUco tags (4x4, ids 13, 5, 1, 9) stand on the posts in the corners;
// the rims of the walls' inner faces pass beside their centres by up to 4 px and meet at the pixels
// below (lines fitted to the rims' edges over the free part of each wall). The tags' own depth readings
// give their range; the walls' readings beside them are useless, bent by up to 150 mm by the light
// between sand and wall. The corners are dropped from there to the sand along the normal of the plane
// through the four. Nominal intrinsics throughout.
inline std::array<Eigen::Vector2d, 4> TagCorners() {
  struct Corner {
    double u, v, tag_m, sand_m;
  };
  const std::array<Corner, 4> measured = {{{99.89, 380.94, 1.076, 1.272},
                                           {450.86, 386.60, 1.066, 1.231},
                                           {452.00, 100.73, 1.063, 1.232},
                                           {100.60, 100.62, 1.075, 1.282}}};
  const Eigen::Vector2d down(0.01074, -0.00239);  // of the tags' plane, z = 1
  std::array<Eigen::Vector2d, 4> feet;
  for (size_t i = 0; i < 4; ++i) {
    const Corner& c = measured[i];
    const Eigen::Vector2d rim((c.u - 256) * c.tag_m / 366, (c.v - 212) * c.tag_m / 366);
    feet[i] = rim + (c.sand_m - c.tag_m) * down;
  }
  return feet;
}

}  // namespace sandwright
