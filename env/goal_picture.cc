#include "env/goal_picture.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <string>

#include "data/base/error.h"
#include "data/picture.h"

namespace sandwright {
namespace {

constexpr int kPanel_px = 480, kGap_px = 10, kCaption_px = 26;
constexpr double kDifference_m = 0.02;

cv::Mat DrawCounted(const HeightMap& goal, double low_m, double high_m, int scale) {
  cv::Mat image = DrawHeights(goal, low_m, high_m, scale);
  for (int row = 0; row < goal.rows; ++row) {
    for (int column = 0; column < goal.columns; ++column) {
      if (goal.mask[goal.Index(row, column)]) continue;
      cv::Mat cell = image(cv::Rect(column * scale, (goal.rows - 1 - row) * scale, scale, scale));
      cell = 0.35 * cell + 0.65 * cv::Scalar(225, 225, 225);
    }
  }
  return image;
}

}  // namespace

cv::Mat DrawGoals(const HeightMap& terrain, const HeightMap& wish, const HeightMap& feasible) {
  SAND_CHECK(wish.SameGrid(terrain) && feasible.SameGrid(terrain));
  const auto [low, high] = std::ranges::minmax(terrain.height_m);
  const auto [lowest, highest] = std::ranges::minmax(wish.height_m);
  const double low_m = std::min(low, lowest), high_m = std::max(high, highest);
  const int scale = std::max(1, kPanel_px / std::max(terrain.rows, terrain.columns));
  const std::pair<std::string, cv::Mat> panels[] = {
      {"terrain", DrawHeights(terrain, low_m, high_m, scale)},
      {"wish", DrawCounted(wish, low_m, high_m, scale)},
      {"nearest feasible", DrawCounted(feasible, low_m, high_m, scale)},
      {"feasible - wish, +-20 mm", DrawDifference(feasible, wish, kDifference_m, scale)}};
  const int across = terrain.columns * scale + kGap_px, down = terrain.rows * scale + kCaption_px;
  cv::Mat sheet(2 * down + kGap_px, 2 * across + kGap_px, CV_8UC3, cv::Scalar(255, 255, 255));
  for (int i = 0; i < 4; ++i) {
    const auto& [caption, image] = panels[i];
    const int x = kGap_px + i % 2 * across, y = kCaption_px + i / 2 * down;
    cv::putText(sheet, caption, {x, y - 8}, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(40, 40, 40), 1, cv::LINE_AA);
    image.copyTo(sheet(cv::Rect(x, y, image.cols, image.rows)));
  }
  return sheet;
}

}  // namespace sandwright
