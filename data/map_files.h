// Height maps to and from the files of other programs, by extension.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "data/height_map.h"

namespace sandwright {

// What a format does not carry is given here and never guessed.
struct MapFileOptions {
  std::string unit;                         // "mm" or "m" of the file's numbers; NPY, NPZ, TIFF, meshes, points
  std::optional<double> cell_size_m = {};   // reading what has no grid of its own
  std::optional<double> low_m = {}, high_m = {};  // PNG: heights of black and white
  std::optional<double> step_m = {};              // PNG: or height of a level above the one below it
  std::optional<int> hole_level = {};             // PNG: the level of holes
  bool fill_holes = false;                        // holes become what spans them
  bool holes_do_not_count = false;                // reading: holes go into `mask` (a goal), not into `valid`
  Datum datum = Datum::kRelative;                 // reading
};

// Whether a name is one of a height map here: .h5 .png .npy .npz .tif .tiff .stl .obj .ply .xyz.
bool IsMapFile(const std::filesystem::path& file);

// Reads a map of any of these formats. Holes are spanned by a membrane and 0 in `valid`. Error naming the file and
// the option that is missing or not allowed there.
HeightMap ReadMapFile(const std::filesystem::path& file, const MapFileOptions& options);

// Writes one; cells that are NaN, or 0 in `valid` or `mask`, are holes. Whole or not at all. Error where the format
// cannot hold them.
void WriteMapFile(const HeightMap& map, const std::filesystem::path& file, const MapFileOptions& options);

}  // namespace sandwright
