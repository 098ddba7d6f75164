// Stroke files: strokes with the terrain before and after (schema "sandwright-strokes", version 1).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "data/height_map.h"
#include "data/stroke.h"

namespace sandwright {

struct StrokeRecord {
  HeightMap before, after;
  Stroke stroke;
  ToolPath path;  // as executed
  Blade blade;
  int64_t sequence = 0, step = 0;           // `after` of a step is `before` of the next
  std::optional<std::string> replicate_of;  // same terrain and stroke as that group, other packing
  std::optional<std::string> time = {};     // of the stroke, ISO 8601
};

// One file: strokes of one source on one bed.
struct StrokeFile {
  std::string source;  // "heightfield" | "dem" | "simulated" | "rig"
  std::string bed;     // identity of the bed; splits go by it
  int64_t seed = 0;
  std::string material = "{}";  // JSON text: whatever the source used
  std::vector<StrokeRecord> strokes;
  std::optional<std::string> workcell = {};  // hash of the cell that it was recorded in
};

// Throws Error naming file and group: missing, truncated or foreign files, other schema or version,
// non-finite heights, mismatched sizes, strokes that CheckStroke rejects.
StrokeFile ReadStrokeFile(const std::filesystem::path& file);
// Whole file, beside and renamed.
void WriteStrokeFile(const StrokeFile& content, const std::filesystem::path& file);

// `.h5` files among `paths`, folders searched (not below), sorted. A folder with a strokes.h5 is the log
// of a rig, whose other maps are no strokes. Error where a path does not exist or nothing is found.
std::vector<std::filesystem::path> FindStrokeFiles(const std::vector<std::string>& paths);

}  // namespace sandwright
