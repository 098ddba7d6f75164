// A bed for whoever watches a run: its heights and what is still missing to the goal.
#pragma once

#include <optional>
#include <vector>

#include "data/base/run_status.h"
#include "data/height_map.h"

namespace sandwright {

// Drawn when they are shown; `goal` on the grid of `bed`.
std::vector<RunPicture> BedPictures(const HeightMap& bed, const std::optional<HeightMap>& goal);

}  // namespace sandwright
