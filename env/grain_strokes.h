// What a stroke through grains depends on, and the force that it takes.
#pragma once

#include <functional>
#include <vector>

#include "env/grain_checks.h"

namespace sandwright {

// A straight stroke through the middle of a level bed [m], along x.
struct LevelStroke {
  double bed_length_m = 0.16, bed_width_m = 0.14, bed_height_m = 0.045;
  double length_m = 0.07, depth_m = 0.02;
};

// That stroke repeated on the same bed with grains displaced by a nanometre, at half the time step,
// and with grains four times as stiff; and on another packing, whose difference is the noise that no
// prediction can pass. Differences are NoiseFloor's, on cells of 4 mm. Beside them the overlap of
// soft and stiff grains, the draft of the blade against the wedge of earth_moving.h, grains lost, and
// the speed at rest.
std::vector<GrainCheck> StrokeChecks(const DemConfig& config, const LevelStroke& stroke,
                                     uint64_t seed, const std::function<bool()>& stop);

}  // namespace sandwright
