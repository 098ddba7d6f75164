// How what the surrogate's net says becomes a change of the map: volume and floor are kept here, not
// learned.
#pragma once

#include <span>
#include <vector>

#include "data/height_map.h"

namespace sandwright {

// Adds `residual_m` (one value a cell of `rect`, row-major) to `map`. A residual that takes sand away
// is an outflow, and a cell gives at most what lies on the floor there, so heights stay >= 0 (on a
// map whose datum is relative the floor is unknown and nothing is limited). With conserve_volume
// the larger of total inflow and total outflow is scaled down to the other: that keeps the volume
// to rounding, and the bound on the outflow with it.
void AddResidual(const CellRect& rect, std::vector<double> residual_m, bool conserve_volume,
                 HeightMap& map);

// Lets sand flow through the faces of the cells of `rect`. flux_m [2, rows, columns] in heights of a
// cell: what goes from a cell to its neighbour in the next column, and in the next row (negative:
// back). A face to a cell beyond `rect` is closed. A cell gives at most what lies on the floor there:
// all that leaves it is scaled down together (the donor limit of FluxNet,
// https://arxiv.org/abs/2602.01941). Conserves volume to rounding, and heights stay >= 0.
void AddFluxes(const CellRect& rect, std::span<const double> flux_m, HeightMap& map);

}  // namespace sandwright
