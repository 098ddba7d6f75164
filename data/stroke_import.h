// Strokes with before and after that others recorded, as stroke files.
#pragma once

#include <filesystem>
#include <optional>

#include "data/map_files.h"
#include "data/stroke_dataset.h"

namespace sandwright {

// An empty file of strokes that were recorded elsewhere: source "imported", `datum` and the origin's name in
// `material`, the bed named after it.
StrokeFile ImportedStrokes(const std::filesystem::path& origin, Datum datum);

// NumPy's .npz of n strokes, in the unit that the names say: before_m, after_m [n, rows, columns]; control_points_m
// [n, 2..4, 3], lines of NaN where a stroke has fewer; degree [n]; speed_mps [n]; the cell by `cell_size_m`, or by
// the array of that name. Step i follows step i - 1 on one bed where before_m is the after_m before it.
// Error naming file, array and what is allowed.
StrokeFile ReadStrokesNpz(const std::filesystem::path& file, const Blade& blade, Datum datum,
                          const std::optional<double>& cell_size_m);

// A table (data/stroke_table.h) whose `before` and `after` name height map files of any format, beside it
// or by full path; `options` are for those.
StrokeFile ReadStrokesCsv(const std::filesystem::path& file, const Blade& blade, const MapFileOptions& options);

}  // namespace sandwright
