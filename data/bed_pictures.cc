#include "data/bed_pictures.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "data/picture.h"

namespace sandwright {
namespace {

constexpr int kWidth_px = 480;
constexpr double kGoalRange_m = 0.012;  // full colour of a difference

int ScaleOf(const HeightMap& map) { return std::max(1, kWidth_px / map.columns); }

// Over the heights that all but a hundredth at both ends lie between: one outlier is not the scale.
std::string HeightsPng(const HeightMap& bed) {
  std::vector<float> heights = bed.height_m;
  std::ranges::sort(heights);
  const size_t tail = heights.size() / 100;
  return EncodePng(
      DrawHeights(bed, heights[tail], heights[heights.size() - 1 - tail], ScaleOf(bed)));
}

}  // namespace

std::vector<RunPicture> BedPictures(const HeightMap& bed, const std::optional<HeightMap>& goal) {
  std::vector<RunPicture> pictures = {{"the bed as seen last", [bed] { return HeightsPng(bed); }}};
  if (goal)
    pictures.push_back({fmt::format("bed less goal: red too high, blue too low; full colour is "
                                    "{:.0f} mm",
                                    1e3 * kGoalRange_m),
                        [bed, goal = *goal] {
                          return EncodePng(DrawDifference(bed, goal, kGoalRange_m, ScaleOf(bed)));
                        }});
  return pictures;
}

}  // namespace sandwright
