// Strokes as drawings for CAD and vector programs, in mm.
#pragma once

#include <filesystem>
#include <vector>

#include "data/stroke.h"

namespace sandwright {

// DXF (AutoCAD R12, ASCII, unit mm): one 3D polyline a stroke on the layer STROKES, in frame B. Curves are
// sampled every 2 mm.
void WriteStrokesDxf(const std::vector<Stroke>& strokes, const std::filesystem::path& file);

// SVG, one user unit a mm, seen from above: x to the right, y of B upwards (so y of SVG is -y of B). One path a
// stroke, curves exact, drawn as wide as the blade; the heights of its control points are in `data-z-mm`.
void WriteStrokesSvg(const std::vector<Stroke>& strokes, const Blade& blade, const std::filesystem::path& file);

}  // namespace sandwright
