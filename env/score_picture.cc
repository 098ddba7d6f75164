#include "env/score_picture.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>

#include "data/picture.h"

namespace sandwright {
namespace {

constexpr int kPanel_px = 300, kGap_px = 12, kTitle_px = 30, kCaption_px = 24, kBar_px = 12,
              kBarRow_px = 44;

void Write(cv::Mat& image, const std::string& text, cv::Point at) {
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar(40, 40, 40), 1,
              cv::LINE_AA);
}

// From `low` to `high` on one row of cells so long that the relief has no slope to shade.
HeightMap Ramp(int columns, double low_m, double high_m) {
  HeightMap ramp(1, columns, 1e3);
  for (int i = 0; i < columns; ++i)
    ramp.At(0, i) = static_cast<float>(low_m + (high_m - low_m) * (i + 0.5) / columns);
  return ramp;
}

void DrawBar(cv::Mat& image, const cv::Mat& colours, cv::Point at, const std::string& low,
             const std::string& middle, const std::string& high) {
  cv::Mat bar;
  cv::resize(colours, bar, {colours.cols, kBar_px}, 0, 0, cv::INTER_NEAREST);
  bar.copyTo(image(cv::Rect(at.x, at.y, bar.cols, bar.rows)));
  const auto label = [&](const std::string& text, double share) {
    int base = 0;
    const int width = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, 0.45, 1, &base).width;
    Write(image, text, {at.x + static_cast<int>(share * (bar.cols - width)), at.y + kBar_px + 16});
  };
  label(low, 0);
  label(middle, 0.5);
  label(high, 1);
}

}  // namespace

cv::Mat DrawScoredStroke(const std::string& title, const HeightMap& before, const HeightMap& truth,
                         const HeightMap& prediction, const CellRect& window, const ToolPath& path,
                         const Blade& blade) {
  const auto [low, high] = std::ranges::minmax(truth.height_m);
  const int scale = std::clamp(kPanel_px / std::max(before.columns, before.rows), 1, 8);
  std::array<cv::Mat, 4> panels = {DrawHeights(before, low, high, scale),
                                   DrawHeights(truth, low, high, scale),
                                   DrawHeights(prediction, low, high, scale),
                                   DrawDifference(prediction, truth, kErrorColours_m, scale)};
  DrawPath(panels[0], before, path, blade, scale);
  cv::rectangle(panels[3],
                cv::Rect(window.column0 * scale, (before.rows - window.row1) * scale,
                         window.columns() * scale, window.rows() * scale),
                cv::Scalar(120, 120, 120));
  const char* captions[] = {"before, and the stroke", "truth", "prediction",
                            "prediction - truth (red: too high)"};

  const int width = std::max(panels[0].cols, kPanel_px), height = panels[0].rows;
  const int column = width + kGap_px, top = kTitle_px + kCaption_px;
  cv::Mat image(top + height + kGap_px + kBarRow_px, kGap_px + 4 * column, CV_8UC3,
                cv::Scalar(255, 255, 255));
  Write(image, title, {kGap_px, 20});
  for (int i = 0; i < 4; ++i) {
    const cv::Mat& panel = panels[static_cast<size_t>(i)];
    const int x = kGap_px + i * column;
    Write(image, captions[i], {x, top - 8});
    panel.copyTo(image(cv::Rect(x, top, panel.cols, panel.rows)));
  }

  const int bars = top + height + kGap_px;
  DrawBar(image, DrawHeights(Ramp(width, low, high), low, high), {kGap_px + column, bars},
          fmt::format("{:.0f} mm", 1e3 * low), "height", fmt::format("{:.0f} mm", 1e3 * high));
  DrawBar(image,
          DrawDifference(Ramp(width, -kErrorColours_m, kErrorColours_m), Ramp(width, 0, 0),
                         kErrorColours_m),
          {kGap_px + 3 * column, bars}, fmt::format("-{:.0f} mm", 1e3 * kErrorColours_m), "0",
          fmt::format("+{:.0f} mm", 1e3 * kErrorColours_m));
  const int length_px = static_cast<int>(blade.width_m / before.cell_size_m * scale);
  cv::line(image, {kGap_px, bars + 6}, {kGap_px + length_px, bars + 6}, cv::Scalar(40, 40, 40), 3);
  Write(image, fmt::format("{:.0f} mm, the blade's width", 1e3 * blade.width_m),
        {kGap_px, bars + kBar_px + 16});
  return image;
}

}  // namespace sandwright
