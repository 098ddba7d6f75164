#include "data/drawing.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "data/base/error.h"

namespace sandwright {

cv::Mat ReadDrawing(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) throw Error(file.string() + ": no such file");
  const cv::Mat image = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
  if (image.empty()) throw Error(file.string() + ": not a picture that can be read");
  if (image.channels() != 1)
    throw Error(fmt::format("{}: a drawing is grey, without transparency; this has {} channels ({})",
                            file.string(), image.channels(),
                            image.channels() == 3 ? "colour" : "colour and transparency"));
  if (image.depth() != CV_8U && image.depth() != CV_16U)
    throw Error(file.string() + ": a drawing has 8 or 16 bits a pixel");
  cv::Mat grey;
  image.convertTo(grey, CV_32F, image.depth() == CV_8U ? 1.0 / 255 : 1.0 / 65535);
  double low = 0, high = 0;
  cv::minMaxLoc(grey, &low, &high);
  if (low == high)
    throw Error(fmt::format("{}: the drawing is empty: all of it is one grey ({:.3f})",
                            file.string(), low));
  return grey;
}

cv::Mat DrawLetters(const std::string& text, int rows, int columns, int line_px) {
  constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
  constexpr double kMeasure = 100;  // scale at which the rounding of sizes does not count
  int below = 0;
  const cv::Size size = cv::getTextSize(text, kFont, kMeasure, 1, &below);
  // Half a line beyond the strokes' middles and one to the edge.
  const double scale = kMeasure * std::min((columns - 3.0 * line_px) / size.width,
                                           (rows - 3.0 * line_px) / size.height);
  if (!(scale > 0))
    throw Error(fmt::format("\"{}\" does not fit into {} x {} pixels with lines of {}", text,
                            columns, rows, line_px));
  cv::Mat image = cv::Mat::zeros(rows, columns, CV_8U);
  cv::putText(image, text,
              {static_cast<int>(std::lround((columns - size.width * scale / kMeasure) / 2)),
               static_cast<int>(std::lround((rows + size.height * scale / kMeasure) / 2))},
              kFont, scale, cv::Scalar(1), line_px);
  image.convertTo(image, CV_32F);
  return image;
}

}  // namespace sandwright
