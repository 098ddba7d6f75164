// Slopes and collapses of grains, against dry sand and published experiments.
#pragma once

#include <functional>
#include <vector>

#include "env/grain_checks.h"

namespace sandwright {

// Extents of a block of sand [m]. Beds of it are settled once a seed (SettledBed).
struct SandBlock {
  double length_m, width_m, height_m;  // along x, y, z
};

// Angle of repose, expected 33 +- 2 degrees: a block between smooth side walls loses its wall at high
// x and drains over that edge. The slope is fitted between a fifth and four fifths of its height.
// Throws Error where that is shorter than 10 mm; all of these throw as RunGrains does.
GrainCheck DrainedSlope(const DemConfig& config, const SandBlock& block, uint64_t seed,
                        const std::function<bool()>& stop);

// The same of a cone poured on the floor in portions of 105 grains, each let go three grains above
// the apex.
GrainCheck PouredCone(const DemConfig& config, int portions, uint64_t seed,
                      const std::function<bool()>& stop);

// A block between smooth side walls loses its wall at high x and collapses: run-out and final height
// against experiments, and energy: it never rises, and at the end nothing moves.
std::vector<GrainCheck> ChannelCollapse(const DemConfig& config, const SandBlock& block,
                                        uint64_t seed, const std::function<bool()>& stop);

// A cylinder collapses on all sides: run-out and final height against experiments.
std::vector<GrainCheck> ColumnCollapse(const DemConfig& config, double radius_m, double height_m,
                                       uint64_t seed, const std::function<bool()>& stop);

}  // namespace sandwright
