// What the surrogate's net sees of a stroke: channels on a window of the map's own grid. No
// rotation, so nothing blurs; the direction of travel is given by channels.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "env/stroke_window.h"

namespace sandwright {

// In order. Lengths are divided by a scale (in brackets) that brings them near one; `near` fades
// from 1 on the path to 0 away from it, exp(-distance / 40 mm).
inline constexpr std::array<std::string_view, 12> kSurrogateChannels = {
    "inside",  // 1 in the window, 0 where it was padded
    "height",  // before, relative to its mean over the window [20 mm]
    "cut",     // before above the blade's lowest passage, where it passed [20 mm]
    "blade",   // the blade's lowest passage, relative to the same mean, where it passed [20 mm]
    "direction_x", "direction_y",  // of travel at the nearest pose, times near
    "remaining",  // arc length from the nearest pose to the end, times near [100 mm]
    "near",
    "ahead",     // along the last direction from the end pose, times end_near [100 mm]
    "end_near",  // exp(-distance to the end pose / 60 mm)
    "wall",      // exp(-distance to the nearest wall / 30 mm)
    "change",    // what the heightfield changed [10 mm]; 0 without one
};
inline constexpr int kSurrogateChannelCount = static_cast<int>(kSurrogateChannels.size());
inline constexpr int kCutChannel = 2;
inline constexpr int kDirectionXChannel = 4;  // the one vector among the channels: x, then y

// The unit of what the net says.
inline constexpr double kResidualScale_m = 0.010;

struct SurrogateInput {
  CellRect window;              // on the map; empty: the stroke lies outside the box
  int rows = 0, columns = 0;    // of the window, padded at its high ends
  std::vector<float> channels;  // [kSurrogateChannelCount, rows, columns]
  std::vector<uint8_t> active;  // [rows, columns] 1 = the stroke can reach it
};

// The window of `path` on `before`, padded to multiples of `multiple` cells. `predicted` is the
// heightfield's map after the stroke, on the same grid (`before` itself without a heightfield). A cell is active within `reach_m` of the
// path, its way ahead of the end (kWindowAhead_m, less the reach) with it; the channels of others
// are zero. reach_m = 0: all cells are active, those of the padding too.
SurrogateInput EncodeStroke(const HeightMap& before, const HeightMap& predicted,
                            const ToolPath& path, const Blade& blade, int multiple,
                            double reach_m = 0);

}  // namespace sandwright
