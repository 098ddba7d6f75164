// A wish and what can be made of it, as one picture to look at.
#pragma once

#include <opencv2/core.hpp>

#include "data/height_map.h"

namespace sandwright {

// Terrain, wish and nearest feasible goal on one height scale (goals pale where they do not count), and the
// feasible goal against the wish (+-20 mm); two in a row, each under its caption.
cv::Mat DrawGoals(const HeightMap& terrain, const HeightMap& wish, const HeightMap& feasible);

}  // namespace sandwright
