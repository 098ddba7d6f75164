// Scattered readings to a height map, and what to do where there are none.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "data/height_map.h"

namespace sandwright {

// Heights at the cell centres of a rows x columns map by moving least squares: a plane through the
// points within `reach_m` of the centre, weighted by a tent, so that neither slopes nor uneven
// sampling shift the surface. `points_m` in frame B. Cells with fewer than three points near are 0
// and 0 in `valid` (always filled); datum is relative.
HeightMap GridPoints(const std::vector<Eigen::Vector3f>& points_m, int rows, int columns,
                     double cell_size_m, double reach_m);

// Holes of a map, by its `valid`.
struct Holes {
  double share = 0;      // of the cells
  double largest_m = 0;  // greatest distance of a hole's cell from a seen one
};
Holes MeasureHoles(const HeightMap& map);

// Heights of the cells that are 0 in `valid` from those around them (the membrane that spans each
// hole, Laplace's equation); `valid` stays. At least one cell must be valid.
void FillHoles(HeightMap& map);

}  // namespace sandwright
