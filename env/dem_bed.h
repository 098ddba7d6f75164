// Beds of grains of any shape: settled once, kept in a cache, carved to a terrain.
#pragma once

#include <cstdint>
#include <functional>

#include "env/dem_config.h"
#include "env/dem_run.h"
#include "env/grains.h"

namespace sandwright {

// A level bed at least `depth_m` of sand deep in a box of width_m x height along y; another seed gives
// another packing. Taken from the cache where it was settled before (same configuration, box and seed).
// Throws Error as RunGrains does, or where the cache cannot be written.
GrainBed SettledBed(const DemConfig& config, double box_width_m, double box_depth_m,
                    double sand_depth_m, uint64_t seed, const std::function<bool()>& stop);

// A bed whose surface comes near to `terrain` (datum floor): a settled one, carved so that its mean
// surface is the terrain's, and brought to rest. Throws Error where the terrain's floor is not known.
GrainBed CarvedBed(const DemConfig& config, const HeightMap& terrain, uint64_t seed,
                   const std::function<bool()>& stop);

}  // namespace sandwright
