// Strokes as a table (CSV), one line a control point.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "data/stroke.h"

namespace sandwright {

struct StrokeRow {
  Stroke stroke;
  std::string before, after;  // names of height map files, as they stand there; empty where not given
};

// Columns by the names in the first line, in any order: stroke (number; equal and adjacent lines are one
// stroke), x_mm, y_mm, z_mm, degree, speed_mps, and where given before and after. Of what belongs to the whole
// stroke its first line counts. Commas; no quotes. Error naming file and line.
std::vector<StrokeRow> ReadStrokeTable(const std::filesystem::path& file);

// Such a table of columns stroke, point, x_mm, y_mm, z_mm, degree, speed_mps; read back bit for bit in mm.
void WriteStrokeTable(const std::vector<Stroke>& strokes, const std::filesystem::path& file);

}  // namespace sandwright
