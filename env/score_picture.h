// One scored stroke as a picture that explains itself.
#pragma once

#include <opencv2/core.hpp>
#include <string>

#include "data/height_map.h"
#include "data/stroke.h"

namespace sandwright {

inline constexpr double kErrorColours_m = 0.012;  // of the error's colours, both ways

// Before (with the path), truth, prediction and error (with the score window) side by side under their
// names, with colour bars and a length to compare with; `title` above them. After figure 6 of Deep
// Sandscapes. The maps have one grid.
cv::Mat DrawScoredStroke(const std::string& title, const HeightMap& before, const HeightMap& truth,
                         const HeightMap& prediction, const CellRect& window, const ToolPath& path,
                         const Blade& blade);

}  // namespace sandwright
