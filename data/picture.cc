#include "data/picture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "data/base/atomic_file.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

using Rgb = std::array<double, 3>;

// Piecewise linear colour scale through `stops`, t in [0, 1].
template <size_t n>
cv::Vec3b Colour(const std::array<Rgb, n>& stops, double t, double brightness = 1) {
  const double position = std::clamp(t, 0.0, 1.0) * (n - 1);
  const size_t i = std::min(static_cast<size_t>(position), n - 2);
  const double a = position - static_cast<double>(i);
  cv::Vec3b bgr;
  for (int c = 0; c < 3; ++c) {
    const auto channel = static_cast<size_t>(c);
    const double value = ((1 - a) * stops[i][channel] + a * stops[i + 1][channel]) * brightness;
    bgr[2 - c] = cv::saturate_cast<uchar>(value);
  }
  return bgr;
}

constexpr std::array<Rgb, 5> kSand = {
    {{62, 39, 28}, {121, 85, 55}, {183, 143, 95}, {225, 196, 145}, {250, 238, 208}}};
constexpr std::array<Rgb, 5> kDiverging = {
    {{20, 60, 150}, {110, 165, 220}, {247, 247, 247}, {235, 140, 105}, {160, 20, 35}}};

cv::Mat Enlarge(const cv::Mat& cells, int pixels_per_cell, int interpolation) {
  cv::Mat flipped, out;
  cv::flip(cells, flipped, 0);
  cv::resize(flipped, out, {}, pixels_per_cell, pixels_per_cell, interpolation);
  return out;
}

}  // namespace

cv::Mat DrawHeights(const HeightMap& map, double low_m, double high_m, int pixels_per_cell) {
  cv::Mat image(map.rows, map.columns, CV_8UC3);
  const double span = std::max(high_m - low_m, 1e-6);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const float h = map.At(row, column);
      if (!std::isfinite(h)) {
        image.at<cv::Vec3b>(row, column) = {200, 200, 200};
        continue;
      }
      // Light from the upper left of the picture (-x, +y).
      const auto slope = [&](int r0, int c0, int r1, int c1) {
        const float a = map.At(std::max(r0, 0), std::max(c0, 0));
        const float b = map.At(std::min(r1, map.rows - 1), std::min(c1, map.columns - 1));
        return std::isfinite(a) && std::isfinite(b) ? (b - a) / (2 * map.cell_size_m) : 0.0;
      };
      const double dx = slope(row, column - 1, row, column + 1);
      const double dy = slope(row - 1, column, row + 1, column);
      const double shade = (1 + 0.9 * (dx - dy)) / std::sqrt(1 + dx * dx + dy * dy);
      image.at<cv::Vec3b>(row, column) =
          Colour(kSand, (h - low_m) / span, std::clamp(shade, 0.45, 1.25));
    }
  }
  return Enlarge(image, pixels_per_cell, cv::INTER_CUBIC);  // relief reads better without steps
}

cv::Mat DrawDifference(const HeightMap& a, const HeightMap& b, double range_m,
                       int pixels_per_cell) {
  SAND_CHECK(a.SameGrid(b) && range_m > 0, range_m);
  cv::Mat image(a.rows, a.columns, CV_8UC3);
  for (int row = 0; row < a.rows; ++row) {
    for (int column = 0; column < a.columns; ++column) {
      const size_t i = a.Index(row, column);
      const double d = static_cast<double>(a.height_m[i]) - b.height_m[i];
      const bool counts = std::isfinite(d) && (b.mask.empty() || b.mask[i]);
      image.at<cv::Vec3b>(row, column) =
          counts ? Colour(kDiverging, 0.5 + 0.5 * d / range_m) : cv::Vec3b{225, 225, 225};
    }
  }
  return Enlarge(image, pixels_per_cell, cv::INTER_NEAREST);
}

void DrawPath(cv::Mat& image, const HeightMap& map, const ToolPath& path, const Blade& blade,
              int pixels_per_cell) {
  constexpr int kShift = 4;  // OpenCV draws at 1/16 px
  const auto pixel = [&](double x_m, double y_m) {
    const double scale = pixels_per_cell / map.cell_size_m * (1 << kShift);
    return cv::Point(static_cast<int>(std::lround(x_m * scale)),
                     static_cast<int>(std::lround((map.depth_m() - y_m) * scale)));
  };
  const cv::Scalar dark(60, 20, 20);
  const auto line = [&](const cv::Point& a, const cv::Point& b, int width) {
    cv::line(image, a, b, dark, width, cv::LINE_AA, kShift);
  };
  for (size_t i = 1; i < path.size(); ++i)
    line(pixel(path[i - 1].x_m, path[i - 1].y_m), pixel(path[i].x_m, path[i].y_m), 2);
  for (const BladePose& end : {path.front(), path.back()}) {
    const double dx = -std::sin(end.yaw_rad) * blade.width_m / 2,
                 dy = std::cos(end.yaw_rad) * blade.width_m / 2;
    line(pixel(end.x_m - dx, end.y_m - dy), pixel(end.x_m + dx, end.y_m + dy), 2);
  }
  const BladePose& last = path.back();
  for (double side : {-2.6, 2.6}) {
    const double heading = last.yaw_rad + side, length = blade.width_m / 4;
    line(pixel(last.x_m, last.y_m),
         pixel(last.x_m + length * std::cos(heading), last.y_m + length * std::sin(heading)), 2);
  }
}

std::string EncodePng(const cv::Mat& bgr) {
  std::vector<uchar> bytes;
  if (!cv::imencode(".png", bgr, bytes))
    throw Error("cannot encode a picture", ErrorKind::kInternal);
  return {bytes.begin(), bytes.end()};
}

void WritePicture(const cv::Mat& bgr, const std::filesystem::path& file) {
  if (file.extension() != ".png")
    throw Error("cannot write picture " + file.string() + ": the name must end in .png");
  WriteFileAtomically(file, EncodePng(bgr));
}

}  // namespace sandwright
