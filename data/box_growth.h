// The first guess of the box: a rectangle that grows over the sand until walls stop it.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <optional>

#include "data/level_image.h"

namespace sandwright {

// A rectangle in L: the axes e, f at `angle` and the extents along them [m].
struct Rectangle {
  double angle = 0;
  std::array<double, 4> side{};  // lowest and highest along e, lowest and highest along f

  Eigen::Vector2d e() const { return {std::cos(angle), std::sin(angle)}; }
  Eigen::Vector2d f() const { return {-std::sin(angle), std::cos(angle)}; }
  double extent(int axis) const {
    const auto a = static_cast<size_t>(2 * axis);
    return side[a + 1] - side[a];
  }
};

// The angles to try: all of a quarter turn, or a few around a known one.
struct AngleRange {
  double first_rad = 0;
  int degrees = 90;
};

// The rectangle whose sides are steeper than `wall_slope` [m/m] on average over the whole of their
// length, and steepest of all angles and seeds; empty where none closes within the picture.
//
// From each of nine seeds, at each angle, a small rectangle pushes its sides outwards until each is
// such a line. A steep place of sand stops no side: it is never steep along all of it, and what
// stops a short side is asked again when the side has grown.
std::optional<Rectangle> GrowRectangle(const LevelImage& image, const AngleRange& angles,
                                       double wall_slope, double min_side_m);

}  // namespace sandwright
