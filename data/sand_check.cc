#include "data/sand_check.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace sandwright {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// Slope of each cell by central differences [deg]; one-sided at the walls.
cv::Mat1d Slopes(const HeightMap& map) {
  cv::Mat1d slopes(map.rows, map.columns);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const int r0 = std::max(row - 1, 0), r1 = std::min(row + 1, map.rows - 1);
      const int c0 = std::max(column - 1, 0), c1 = std::min(column + 1, map.columns - 1);
      const double dx = (map.At(row, c1) - map.At(row, c0)) / ((c1 - c0) * map.cell_size_m);
      const double dy = (map.At(r1, column) - map.At(r0, column)) / ((r1 - r0) * map.cell_size_m);
      slopes(row, column) = std::atan(std::hypot(dx, dy)) / kDegree;
    }
  }
  return slopes;
}

// Area of the largest gentle place inside a closed steep ring [m^2].
double LargestObject(const HeightMap& map, const cv::Mat1d& slopes, const SandCheckConfig& config) {
  cv::Mat gentle = slopes < config.object_edge_deg, labels, stats, centres;
  const int count = cv::connectedComponentsWithStats(gentle, labels, stats, centres, 4);
  double largest = 0;
  for (int label = 1; label < count; ++label) {
    const int left = stats.at<int>(label, cv::CC_STAT_LEFT),
              top = stats.at<int>(label, cv::CC_STAT_TOP);
    const int right = left + stats.at<int>(label, cv::CC_STAT_WIDTH);
    const int bottom = top + stats.at<int>(label, cv::CC_STAT_HEIGHT);
    if (left == 0 || top == 0 || right == map.columns || bottom == map.rows) continue;
    const double area = stats.at<int>(label, cv::CC_STAT_AREA) * map.cell_size_m * map.cell_size_m;
    if (area <= largest) continue;
    std::vector<double> inside;
    for (int row = top; row < bottom; ++row)
      for (int column = left; column < right; ++column)
        if (labels.at<int>(row, column) == label) inside.push_back(slopes(row, column));
    const auto middle = inside.begin() + static_cast<std::ptrdiff_t>(inside.size() / 2);
    std::nth_element(inside.begin(), middle, inside.end());
    if (*middle < config.object_top_deg) largest = area;
  }
  return largest;
}

}  // namespace

std::vector<std::string> ReasonsNotSand(const HeightMap& map, const SandCheckConfig& config) {
  std::vector<std::string> reasons;
  const auto [low, high] = std::ranges::minmax(map.height_m);
  if (high - low > config.max_relief_m)
    reasons.push_back(
        fmt::format("the heights span {:.0f} mm; sand in a box spans at most {:.0f} mm "
                    "(an arm, the floor, or a wall is in view)",
                    1000 * (high - low), 1000 * config.max_relief_m));
  const cv::Mat1d slopes = Slopes(map);
  const double steep = static_cast<double>(cv::countNonZero(slopes > config.steep_deg)) /
                       static_cast<double>(map.size());
  if (steep > config.max_steep_share)
    reasons.push_back(
        fmt::format("{:.1f} % of the cells are steeper than {:.0f} degrees; at most "
                    "{:.1f} % are allowed in sand",
                    100 * steep, config.steep_deg, 100 * config.max_steep_share));
  const double object = LargestObject(map, slopes, config);
  if (object > config.max_object_m2)
    reasons.push_back(
        fmt::format("an edge steeper than {:.0f} degrees encloses {:.1f} cm^2 all round: "
                    "a hard object on the sand (at most {:.1f} cm^2 are let pass)",
                    config.object_edge_deg, 1e4 * object, 1e4 * config.max_object_m2));
  return reasons;
}

}  // namespace sandwright
