// Sand whose final shape is known in closed form: what the heightfield's numerics are held to.
//
// The inertia-free limit of dry sand: slopes end at the angle of repose, nothing overshoots (Prigozhin,
// "Variational model of sandpile growth", 1996). Formulas: docs/sand.md.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "data/height_map.h"

namespace sandwright {

struct ExactCase {
  std::string name;
  HeightMap start;
  int portions = 1;    // the start is poured in so many equal parts, each coming to rest
  HeightMap expected;  // `mask` 0: does not count (walls that slopes meet obliquely)
};

// All cases at `repose_deg`, on cells of `cell_size_m`; extents scale with the cell.
std::vector<ExactCase> ExactCases(double repose_deg, double cell_size_m);

// What the heightfield's avalanche makes of a case.
HeightMap SettleCase(const ExactCase& exact, double repose_deg);

// Difference over the cells that count, in cells.
struct CellError {
  double rmse = 0, mean = 0, largest = 0;
};
CellError Differ(const HeightMap& map, const HeightMap& expected);

// How far a heap around the map's middle is from round at half its height: (largest - smallest) / mean
// radius of the contour, over all directions.
double ContourSpread(const HeightMap& heap);

}  // namespace sandwright
