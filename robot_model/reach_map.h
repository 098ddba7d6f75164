// Where in the box the arm can start a stroke.
#pragma once

#include <vector>

namespace sandwright {

class SafetyGate;

// Over cells of about 25 mm, row 0 at the smallest y of B.
struct ReachMap {
  int rows = 0, columns = 0;
  double width_m = 0, depth_m = 0;  // of the box, along x and y
  std::vector<float> share;         // [rows, columns] of headings, 0..1

  // Of the cell that holds a point of B; 0 outside the walls.
  float At(double x_m, double y_m) const;
};

// The share of eight headings in which the coarse gate lets a line of 40 mm start in the middle of a
// cell, its edge on level sand 50 mm deep. SafetyGate::reach keeps one.
// Error where the box is no whole number of mm.
ReachMap MeasureReach(const SafetyGate& gate);

}  // namespace sandwright
