// Height maps as grey pictures: a PNG of 16 bits.
#pragma once

#include <filesystem>
#include <optional>

#include "data/height_map.h"

namespace sandwright {

// What the levels of a picture stand for: height = low_m + level * step_m.
struct GreyScale {
  double low_m = 0;
  double step_m = 0;
  std::optional<int> hole_level = {};  // the level that means "nothing here"; not given: none does
};

// Grey PNG of 8 or 16 bits; row 0 of the map is at the bottom of the picture. Holes are NaN, the datum is relative.
// Error naming the file: missing, cut off, colour.
HeightMap ReadGreyLevels(const std::filesystem::path& file, const GreyScale& scale, double cell_size_m);

// The highest level of such a file (255 or 65535), for scales that are given by their ends.
int HighestLevel(const std::filesystem::path& file);

// 16 bits, whole or not at all; each height becomes the nearest level. Error naming the height that is
// beyond the scale, or that would take the level of holes; or a hole (NaN) without such a level.
void WriteGreyLevels(const HeightMap& map, const GreyScale& scale, const std::filesystem::path& file);

}  // namespace sandwright
