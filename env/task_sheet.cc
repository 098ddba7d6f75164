#include "env/task_sheet.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "data/base/error.h"
#include "data/picture.h"

namespace sandwright {
namespace {

constexpr int kPanel_px = 180, kGap_px = 8, kCaption_px = 22, kTasksARow = 4;

cv::Mat DrawGoal(const HeightMap& goal, double low_m, double high_m, int scale) {
  cv::Mat image = DrawHeights(goal, low_m, high_m, scale);
  for (int row = 0; row < goal.rows; ++row) {
    for (int column = 0; column < goal.columns; ++column) {
      if (goal.mask[goal.Index(row, column)]) continue;
      cv::Mat cell =
          image(cv::Rect(column * scale, (goal.rows - 1 - row) * scale, scale, scale));
      cell = 0.35 * cell + 0.65 * cv::Scalar(225, 225, 225);
    }
  }
  return image;
}

}  // namespace

cv::Mat DrawTasks(std::span<const Task> tasks) {
  SAND_CHECK(!tasks.empty());
  int width = 0, height = 0;
  for (const Task& task : tasks) {
    width = std::max(width, task.terrain.columns);
    height = std::max(height, task.terrain.rows);
  }
  const int scale = std::max(1, kPanel_px / std::max(width, height));
  const int panel = width * scale, across = 2 * panel + 3 * kGap_px;
  const int down = kCaption_px + height * scale + kGap_px;
  const auto count = static_cast<int>(tasks.size());
  cv::Mat sheet((count + kTasksARow - 1) / kTasksARow * down, std::min(count, kTasksARow) * across,
                CV_8UC3, cv::Scalar(255, 255, 255));
  for (int i = 0; i < count; ++i) {
    const auto& [terrain, goal, budget] = tasks[static_cast<size_t>(i)];
    const auto range = std::ranges::minmax(terrain.height_m);
    const int x = i % kTasksARow * across + kGap_px, y = i / kTasksARow * down + kCaption_px;
    cv::putText(sheet,
                fmt::format("{}: {:.1f} mm, {} strokes", i, 1e3 * GoalError(terrain, goal), budget),
                {x, y - 7}, cv::FONT_HERSHEY_SIMPLEX, 0.42, cv::Scalar(40, 40, 40), 1, cv::LINE_AA);
    const auto place = [&](const cv::Mat& image, int left) {
      image.copyTo(sheet(cv::Rect(left, y, image.cols, image.rows)));
    };
    place(DrawHeights(terrain, range.min, range.max, scale), x);
    place(DrawGoal(goal, range.min, range.max, scale), x + panel + kGap_px);
  }
  return sheet;
}

}  // namespace sandwright
