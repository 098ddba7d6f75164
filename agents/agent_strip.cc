#include "agents/agent_strip.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "data/picture.h"

namespace sandwright {
namespace {

constexpr int kPanel_px = 180, kGap_px = 8, kCaption_px = 24;
constexpr double kError_m = 0.012;

}  // namespace

cv::Mat DrawAgentStrip(const Task& task, std::span<const AgentEnd> ends) {
  const auto [low, high] = std::ranges::minmax(task.terrain.height_m);
  const int scale = std::max(1, kPanel_px / std::max(task.terrain.rows, task.terrain.columns));
  const int width = task.terrain.columns * scale, height = task.terrain.rows * scale;
  const int columns = 2 + static_cast<int>(ends.size());
  cv::Mat strip(kCaption_px + 2 * (height + kGap_px), columns * (width + kGap_px) + kGap_px, CV_8UC3,
                cv::Scalar(255, 255, 255));
  const auto column = [&](int i, const std::string& name, const HeightMap& map, bool error) {
    const int x = kGap_px + i * (width + kGap_px);
    const std::string caption =
        error ? fmt::format("{} {:.1f} mm", name, 1e3 * GoalError(map, task.goal)) : name;
    cv::putText(strip, caption, {x, kCaption_px - 8}, cv::FONT_HERSHEY_SIMPLEX, 0.42, cv::Scalar(40, 40, 40), 1,
                cv::LINE_AA);
    DrawHeights(map, low, high, scale).copyTo(strip(cv::Rect(x, kCaption_px, width, height)));
    if (error)
      DrawDifference(map, task.goal, kError_m, scale)
          .copyTo(strip(cv::Rect(x, kCaption_px + height + kGap_px, width, height)));
  };
  column(0, "start", task.terrain, true);
  column(1, "goal", task.goal, false);
  for (int i = 2; i < columns; ++i) {
    const AgentEnd& end = ends[static_cast<size_t>(i - 2)];
    column(i, end.agent, end.end, true);
  }
  return strip;
}

}  // namespace sandwright
