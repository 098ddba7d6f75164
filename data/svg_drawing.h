// Vector drawings (SVG) as grooves, ridges and areas: a small subset, docs/goals.md.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "data/height_map.h"
#include "data/svg_path.h"

namespace sandwright {

struct SvgShape {
  std::vector<SvgLine> lines;      // in the drawing's page, units of the page, y down
  bool filled = false;             // the lines' inside, by even and odd
  double stroke_width = 0;         // along the lines; 0: not drawn
  std::optional<double> depth_mm;  // `data-depth-mm` of the element or a group around it; negative: a ridge
};

struct SvgDrawing {
  double width = 0, height = 0;            // of the page, in its units
  std::optional<double> unit_m;            // of its units, where the page's width says so
  std::vector<SvgShape> shapes;            // in the order in which they are drawn
};

// Elements path, line, polyline, polygon, rect, circle, ellipse, in g and svg, with transform, fill, stroke and
// stroke-width as attributes or in `style`. What draws otherwise (text, image, use, ...) is an Error naming it; so are a
// file that is no SVG, no page (viewBox, or width and height), and nothing that is drawn.
SvgDrawing ReadSvg(const std::filesystem::path& file);

// The drawing as heights on cells of `cell`, in units of the page, row 0 at the bottom: 0 where nothing is drawn, the
// depth below elsewhere, later shapes over earlier ones. `depth_mm` is for those that name none; Error naming
// `source` where it is needed and not given.
HeightMap DrawSvg(const SvgDrawing& drawing, double cell, const std::optional<double>& depth_mm, const std::string& source);

}  // namespace sandwright
