// The action: seven numbers in [-1, 1] and the one place where they become a stroke.
#pragma once

#include <array>
#include <string_view>

#include "data/height_map.h"
#include "data/stroke.h"

namespace sandwright {

// The part of the box that a task is about: a rectangle in frame B. Actions and observations are
// relative to it, so one policy serves any place of any box.
struct Region {
  double x_m = 0, y_m = 0;          // corner nearest B's origin
  double width_m = 0, depth_m = 0;  // extent along x and y
};

inline constexpr int kActionSize = 7;
using Action = std::array<float, kActionSize>;

// Declared once: name and physical range of each number; -1 is `low`, 1 is `high`.
struct ActionEntry {
  std::string_view name;
  double low, high;
};
inline constexpr std::array<ActionEntry, kActionSize> kActionSpec = {{
    {"start_x", 0, 1},  // share of the region's width
    {"start_y", 0, 1},  // share of the region's depth
    {"heading_rad", -3.14159265358979323846, 3.14159265358979323846},  // of the chord
    {"length_m", 0.040, 0.180},                                        // of the chord
    {"depth_start_m", -0.005, 0.030},  // below the mean sensed height under the blade at the start
    {"depth_end_m", -0.005, 0.030},    // the same at the end
    {"bend", -0.5, 0.5},  // sideways offset of the middle control point as a share of length
}};

// The heading alone goes round.
inline constexpr size_t kHeadingEntry = 2;
static_assert(kActionSpec[kHeadingEntry].name == "heading_rad");

// `value` of entry `entry` brought into [-1, 1]: the heading goes round, the others stop at the bounds.
float WithinBounds(size_t entry, double value);

// The only way from an action to a stroke. Depths are taken below the mean *sensed* height under
// the blade at that end. Never shifts a stroke to make it fit: what leaves the box is the gate's to
// reject. Values beyond [-1, 1] by at most 1e-6 are taken as the bound; more, or NaN, throws Error.
Stroke DecodeAction(const Action& action, const HeightMap& sensed, const Region& region,
                    const Blade& blade, double speed_mps);

// Mean sensed height [m] under a blade that stands at `p` [m] in frame B and travels along `direction`.
double SandUnderBlade(const HeightMap& sensed, const Eigen::Vector2d& p,
                      const Eigen::Vector2d& direction, const Blade& blade);

// The inverse for a line: the action whose stroke runs from `start_m` to `end_m` (x, y, z of the blade's
// lower edge in frame B, apart in the plane). What no action reaches is brought to the nearest bound: the
// start into the region, length and depths into their ranges.
Action EncodeLine(const Eigen::Vector3d& start_m, const Eigen::Vector3d& end_m,
                  const HeightMap& sensed, const Region& region, const Blade& blade);

}  // namespace sandwright
