#include "env/drawn_goal.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "env/avalanche.h"
#include "env/goals.h"

namespace sandwright {
namespace {

// The drawing on pixels of `pixel_m` without what is narrower than kNarrowestPixels: 0 to 1.
HeightMap WideParts(const cv::Mat& grey, const Region& place, double narrowest_m) {
  const double pixel_m = narrowest_m / kNarrowestPixels;
  const cv::Size size(std::max(2, static_cast<int>(std::lround(place.width_m / pixel_m))),
                      std::max(1, static_cast<int>(std::lround(place.depth_m / pixel_m))));
  cv::Mat image;
  cv::resize(grey, image, size, 0, 0, size.width < grey.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
  // Odd, so that nothing shifts; the pixel that is missing is the drawing's own blur.
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE,
                                                 {kNarrowestPixels - 1, kNarrowestPixels - 1});
  cv::morphologyEx(image, image, cv::MORPH_OPEN, disc);
  cv::morphologyEx(image, image, cv::MORPH_CLOSE, disc);
  HeightMap relief(image.rows, image.cols, pixel_m);
  for (int row = 0; row < image.rows; ++row)  // a picture has its first row at the top
    std::copy_n(image.ptr<float>(image.rows - 1 - row), image.cols, &relief.At(row, 0));
  return relief;
}

// Rows and columns whose centres lie in `place`.
CellRect CellsIn(const Region& place, const HeightMap& map) {
  const auto first = [&](double at_m) {
    return static_cast<int>(std::ceil(at_m / map.cell_size_m - 0.5 - 1e-9));
  };
  return {std::max(0, first(place.y_m)), std::max(0, first(place.x_m)),
          std::min(map.rows, first(place.y_m + place.depth_m)),
          std::min(map.columns, first(place.x_m + place.width_m))};
}

}  // namespace

HeightMap MakeDrawnGoal(const cv::Mat& grey, double range_m, const HeightMap& terrain,
                        const Region& region, double narrowest_m, double slope) {
  SAND_CHECK(grey.type() == CV_32F && narrowest_m > 0 && slope > 0, narrowest_m, slope);
  const double pixel_m = std::min(region.width_m / grey.cols, region.depth_m / grey.rows);
  const double width_m = pixel_m * grey.cols, depth_m = pixel_m * grey.rows;
  const Region place{region.x_m + (region.width_m - width_m) / 2,
                     region.y_m + (region.depth_m - depth_m) / 2, width_m, depth_m};
  const CellRect cells = CellsIn(place, terrain);
  if (cells.empty() || cells.columns() < 2)
    throw Error(fmt::format("a drawing of {} x {} pixels covers no two cells of its place of {:g} x "
                            "{:g} m",
                            grey.cols, grey.rows, region.width_m, region.depth_m));
  const HeightMap relief = WideParts(grey, place, narrowest_m);
  const auto [low, high] = std::ranges::minmax(relief.height_m);
  if (high - low < 1e-3)
    throw Error(fmt::format("nothing in the drawing is as wide as {:g} mm where it is laid into {:.0f} "
                            "x {:.0f} mm",
                            1e3 * narrowest_m, 1e3 * width_m, 1e3 * depth_m));

  HeightMap patch =
      SampleOnto(relief, cells.column0 * terrain.cell_size_m - place.x_m,
                 cells.row0 * terrain.cell_size_m - place.y_m, cells.rows(), cells.columns(),
                 terrain.cell_size_m);
  for (float& h : patch.height_m) h = static_cast<float>(range_m * (range_m < 0 ? h - 1 : h));
  RelaxToRepose(patch, std::atan(slope) * 180 / std::numbers::pi);
  HeightMap wish = terrain;
  wish.mask.assign(wish.size(), 0);
  Paste(patch, cells, wish);
  for (int row = cells.row0; row < cells.row1; ++row)
    std::fill_n(wish.mask.begin() + static_cast<std::ptrdiff_t>(wish.Index(row, cells.column0)),
                cells.columns(), uint8_t{1});
  return BalanceGoal(wish, terrain, "drawn");
}

}  // namespace sandwright
