// Pictures of height maps for people (PNG). Row 0 is at the bottom, as in frame B.
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "data/height_map.h"
#include "data/stroke.h"

namespace sandwright {

// Heights as shaded relief over a sand colour scale between low and
// high [m]; `pixels_per_cell` >= 1.
cv::Mat DrawHeights(const HeightMap& map, double low_m, double high_m, int pixels_per_cell = 1);
// Signed difference a - b on a diverging scale: blue below, white zero, red above, +-range_m.
// Cells whose `mask` of `b` is 0 are grey.
cv::Mat DrawDifference(const HeightMap& a, const HeightMap& b, double range_m,
                       int pixels_per_cell = 1);

// Draws a tool path over a picture of `map` of that scale: the line of the blade's middle, the
// blade across it at both ends, an arrow head at the last.
void DrawPath(cv::Mat& image, const HeightMap& map, const ToolPath& path, const Blade& blade,
              int pixels_per_cell);

// Writes by extension (.png), whole or not at all.
void WritePicture(const cv::Mat& bgr, const std::filesystem::path& file);
// The PNG bytes, for pages that carry their pictures.
std::string EncodePng(const cv::Mat& bgr);

}  // namespace sandwright
