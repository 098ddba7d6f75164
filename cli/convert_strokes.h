// Strokes between the files of this program and those of others, for `convert`.
#pragma once

#include <filesystem>
#include <vector>

#include "data/map_files.h"
#include "data/stroke_dataset.h"

namespace sandwright {

// Whether strokes can be written to a file of this name: .dxf .svg .csv .yaml .yml.
bool IsStrokesFile(const std::filesystem::path& file);

// The strokes of a plan (.yaml), a stroke file (.h5) or a table (.csv). Error naming the file.
std::vector<Stroke> ReadStrokesOf(const std::filesystem::path& file);
// By extension; `blade` is how wide SVG draws them. A plan is written unsealed.
void WriteStrokesTo(const std::vector<Stroke>& strokes, const Blade& blade, const std::filesystem::path& file);

// Strokes with before and after: .npz, .csv, .png (a picture pair) or a folder of those.
StrokeFile ReadRecordedStrokes(const std::filesystem::path& path, const Blade& blade, const MapFileOptions& options);

}  // namespace sandwright
