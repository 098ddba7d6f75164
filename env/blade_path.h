// A tool path as sand models walk it.
#pragma once

#include "data/height_map.h"
#include "data/stroke.h"

namespace sandwright {

// How far any point of the blade goes between two poses, at most [m]; rising and sinking do not count.
double Travel(const BladePose& a, const BladePose& b, const Blade& blade);

// The path in equal steps of travel, at most `step_m` each: independent of how it was sampled.
ToolPath EqualSteps(const ToolPath& path, double step_m, const Blade& blade);

// A path that keeps to the floor, and what had to give.
struct LimitedPath {
  ToolPath path;
  bool left_box = false;     // part of the blade lies outside the walls
  bool below_floor = false;  // raised to the floor (only where `map` knows its floor)
};
LimitedPath LimitPath(const ToolPath& path, const Blade& blade, const HeightMap& map);

}  // namespace sandwright
