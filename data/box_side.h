// One wall of the box: where it meets the sand, read by scan lines across it.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "data/level_image.h"

namespace sandwright {

// What is known of a side before it is read, in the level frame L: its direction outwards (unit), the
// direction along it, where it is expected, from where to where it runs, and the sand's height.
struct SideGuess {
  Eigen::Vector2d outward, along;
  double position_m = 0;  // along `outward`
  double low_m = 0, high_m = 0;
  double inside_m = 0;  // how far inside of `position_m` the scan lines begin
  double sand_m = 0;    // z in L
};

// One wall as the scan lines across it saw it.
struct BoxSide {
  double support = 0;     // share of the length on which the wall was met within the tolerance
  double spread_m = 0;    // standard deviation of those meetings about the line
  double rise_m = 0;      // median height of the wall's highest reading above the sand beside it
  double position_m = 0;  // of the side's middle, along `outward`
  double lean_rad = 0;    // turn of the side's line: position grows along `along`
  double rival_m = 0;     // how far inside a second edge runs, nearly as steep; 0 = none
  std::vector<Eigen::Vector3f> rim_C;  // the wall's highest readings, one a stretch
};

// The innermost line that is steeper on its whole length, on average, than `wall_slope` [m/m] and than
// the surface inside of it: sand may stand that steep here and there, hardly along all of a straight
// line, and a bank that does has no edge where it is steep.
BoxSide ReadSide(const LevelImage& image, const SideGuess& guess, double wall_slope);

}  // namespace sandwright
