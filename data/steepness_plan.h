// How steep the surface is, seen in plan: what tells a wall from sand before any line is known.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "data/level_image.h"

namespace sandwright {

// A place of L with the steepness of the surface there [m/m], capped at kSteepnessCap.
struct SteepPoint {
  Eigen::Vector2f xy;
  float steepness;
};

// No stretch may speak for others: a hand or a tool stands steeper than any bank of sand.
inline constexpr float kSteepnessCap = 1.2f;

// One a reading whose neighbours two pixels apart in both directions of the picture were seen.
std::vector<SteepPoint> SteepPoints(const LevelImage& image);

// The mean steepness of the points in the square cells of a grid turned against L, and of straight
// lines along its axes. Axis 0 is e = (cos, sin) of the angle, axis 1 is f = (-sin, cos).
class SteepnessPlan {
 public:
  // Covers `reach_m` around `middle`.
  SteepnessPlan(const std::vector<SteepPoint>& points, const Eigen::Vector2d& middle,
                double reach_m, double angle_rad, double cell_m);

  int cells() const { return cells_; }  // on either axis
  // Cell and coordinate of a place on an axis, from the grid's edge on; coordinates are those of L
  // along e or f.
  int Cell(const Eigen::Vector2d& xy, int axis) const;
  double Position(int cell, int axis) const { return low_[axis] + (cell + 0.5) * cell_m_; }

  // Mean steepness of the line at `cell` of `axis` from cell `from` to cell `to` (both included) of
  // the other axis; NaN where less than half of it was seen.
  //
  // A line is three cells wide: each stretch of it counts by the steepest of the three, since
  // neither a wall nor the grid's angle is straight to a cell. A stretch is nine cells long and is
  // averaged before: the steepest of single readings would be noise, and noise makes sand as steep
  // as a wall.
  double LineSteepness(int axis, int cell, int from, int to) const;

 private:
  void AddLines(int axis, const std::vector<float>& sum, const std::vector<int>& count);
  size_t Index(int cell, int along) const {
    return static_cast<size_t>(cell) * static_cast<size_t>(cells_ + 1) + static_cast<size_t>(along);
  }

  double cell_m_;
  int cells_;
  Eigen::Vector2d low_;
  Eigen::Matrix2d axes_;  // rows e, f
  // For each axis, line by line, running sums along it: of steepness and of the cells seen.
  std::array<std::vector<float>, 2> steepness_, seen_;
};

}  // namespace sandwright
