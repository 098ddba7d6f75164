// The part of a map that one stroke can change noticeably.
#pragma once

#include "data/height_map.h"
#include "data/stroke.h"

namespace sandwright {

inline constexpr double kWindowMargin_m = 0.075;  // around the path
inline constexpr double kWindowAhead_m = 0.120;   // beyond the path's end, in its last direction

// The cells of `map` that touch the rectangle around the positions of `path`, grown by
// kWindowMargin_m on all sides and further until it holds the point kWindowAhead_m ahead of the
// last pose; clipped to the map (empty where nothing is left). The path must not be empty.
CellRect StrokeWindow(const HeightMap& map, const ToolPath& path);

// Bounds of the cells where two maps of one grid differ by more than `threshold_m` (may be empty).
CellRect ChangedBounds(const HeightMap& before, const HeightMap& after, double threshold_m);

}  // namespace sandwright
