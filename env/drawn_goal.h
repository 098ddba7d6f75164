// Goals from drawings: grey becomes height, as far as sand and blade allow.
#pragma once

#include <opencv2/core.hpp>

#include "data/height_map.h"
#include "env/action.h"

namespace sandwright {

// `grey` (data/drawing.h) laid into the middle of `region` as large as its proportions allow: black is
// `range_m` below white; negative: above. Made reachable: what is narrower than `narrowest_m`, high or low,
// is left out, slopes beyond `slope` (rise over run) slide to rest as sand would, and the goal has the
// terrain's volume over the mask, which is the drawing's rectangle. Throws Error where nothing is as
// wide as `narrowest_m`, no cell is covered, or the goal is lower than the floor.
HeightMap MakeDrawnGoal(const cv::Mat& grey, double range_m, const HeightMap& terrain,
                        const Region& region, double narrowest_m, double slope);

// Pixels of a drawing over `narrowest_m` once it is laid into the sand: what thins out is judged on them.
inline constexpr int kNarrowestPixels = 12;

}  // namespace sandwright
