#include "data/grey_levels.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "data/base/atomic_file.h"
#include "data/picture.h"

namespace sandwright {
namespace {

constexpr int kHighest = 65535;

cv::Mat ReadGrey(const std::filesystem::path& file) {
  const std::string bytes = ReadFile(file);
  // The decoder takes a cut-off file for a whole one with black rows; its last chunk tells.
  if (!bytes.starts_with("\x89PNG") || bytes.size() < 12 || bytes.substr(bytes.size() - 8, 4) != "IEND")
    throw Error(file.string() + ": not a PNG file, or cut off");
  const cv::Mat image =
      cv::imdecode(cv::Mat(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data())),
                   cv::IMREAD_UNCHANGED);
  if (image.empty()) throw Error(file.string() + ": the picture is damaged");
  if (image.type() != CV_16UC1 && image.type() != CV_8UC1)
    throw Error(fmt::format("{}: {} channels of {} bits; heights are one channel (grey) of 16 bits, or of 8",
                            file.string(), image.channels(), 8 * image.elemSize1()));
  return image;
}

}  // namespace

int HighestLevel(const std::filesystem::path& file) {
  return ReadGrey(file).depth() == CV_8U ? 255 : kHighest;
}

HeightMap ReadGreyLevels(const std::filesystem::path& file, const GreyScale& scale, double cell_size_m) {
  const cv::Mat image = ReadGrey(file);
  HeightMap map(image.rows, image.cols, cell_size_m, 0, Datum::kRelative);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const int v = map.rows - 1 - row;
      const int level = image.depth() == CV_8U ? image.at<uint8_t>(v, column) : image.at<uint16_t>(v, column);
      map.At(row, column) = scale.hole_level == level ? std::numeric_limits<float>::quiet_NaN()
                                                      : static_cast<float>(scale.low_m + level * scale.step_m);
    }
  }
  return map;
}

void WriteGreyLevels(const HeightMap& map, const GreyScale& scale, const std::filesystem::path& file) {
  SAND_CHECK(scale.step_m > 0, scale.step_m);
  cv::Mat image(map.rows, map.columns, CV_16U);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const double h = map.At(row, column);
      const auto fail = [&](const std::string& what) {
        throw Error(fmt::format("cannot write {}: row {}, column {} {}", file.string(), row, column, what));
      };
      if (std::isnan(h) && !scale.hole_level) fail("is a hole; --hole-level N keeps holes as a level, --fill closes them");
      const double level = std::isnan(h) ? *scale.hole_level : std::round((h - scale.low_m) / scale.step_m);
      if (level < 0 || level > kHighest)
        fail(fmt::format("is {:.4f} mm high; the levels go from {:.4f} to {:.4f} mm", 1e3 * h, 1e3 * scale.low_m,
                         1e3 * (scale.low_m + kHighest * scale.step_m)));
      if (!std::isnan(h) && scale.hole_level == static_cast<int>(level))
        fail(fmt::format("is {:.4f} mm high, which is level {}, the level of holes", 1e3 * h, level));
      image.at<uint16_t>(map.rows - 1 - row, column) = static_cast<uint16_t>(level);
    }
  }
  WritePicture(image, file);
}

}  // namespace sandwright
