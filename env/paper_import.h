// Pairs of pictures as pix2pix data sets keep them (env/paper_encoding.h), back as strokes.
#pragma once

#include <filesystem>

#include "data/stroke_dataset.h"

namespace sandwright {

// One PNG of 512 x 256 pixels in three channels of 8 bits: terrain, path and depth on the left, the terrain
// after on the right. The maps have 256 x 256 cells of 1 mm, relative to the lowest point, the stroke runs towards -y in their
// middle. The picture does not hold the stroke's control points: they are one Bezier curve of four (a line: two)
// fitted to the way's middle and to its depth; corners become round. Error naming the file: another form, no
// path, or a way that no such curve gives back (an overlap of less than 80 % of the pixels), as of strokes that cross
// themselves.
StrokeRecord ReadPaperPair(const std::filesystem::path& file, const Blade& blade);

// A pair, or every .png of a folder in the order of their names, each a sequence of its own. Pairs that cannot
// be taken are left out with a warning; Error where none is left.
StrokeFile ReadPaperPairs(const std::filesystem::path& path, const Blade& blade);

}  // namespace sandwright
