// The error measure of Deep Sandscapes (Tsuruta et al., ANNSIM 2022), to stand beside its figures.
#pragma once

#include "data/height_map.h"
#include "data/stroke.h"

namespace sandwright {

struct PaperScore {
  double mae_mm = 0, rmse_mm = 0, max_abs_mm = 0;
};

// Truth and prediction seen as the paper's pictures: 256 x 256 pixels of 1 mm, centred on the
// middle between the first and the last point of the path and turned so that the way from one to
// the other runs from top to bottom; 8 bit over 0-150 mm above the lowest point of both crops.
// Pixels beyond the walls do not count. A path that ends where it began keeps its last direction as
// the way down.
PaperScore ScorePaperCrop(const HeightMap& truth, const HeightMap& prediction,
                          const ToolPath& path);

}  // namespace sandwright
