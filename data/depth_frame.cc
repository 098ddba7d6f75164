#include "data/depth_frame.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/npy.h"

namespace sandwright {
namespace {

double UnitScale(const std::string& unit) {
  if (unit == "mm") return 1e-3;
  if (unit == "m") return 1;
  if (unit == "0.1mm") return 1e-4;
  throw Error("depth unit '" + unit + "' is not known; allowed: mm, m, 0.1mm");
}

DepthFrame ReadPng(const std::filesystem::path& file, double scale) {
  const std::string bytes = ReadFile(file);
  cv::Mat image;
  if (!bytes.empty())
    image = cv::imdecode(
        cv::Mat(1, static_cast<int>(bytes.size()), CV_8U, const_cast<char*>(bytes.data())),
        cv::IMREAD_UNCHANGED);
  if (image.empty()) throw Error(file.string() + ": not a picture, or cut off");
  if (image.type() != CV_16UC1)
    throw Error(
        fmt::format("{}: a depth frame needs one channel of 16 bits; this picture has {} "
                    "of {} bits",
                    file.string(), image.channels(), 8 * image.elemSize1()));
  DepthFrame frame{image.cols, image.rows, {}};
  frame.depth_m.reserve(image.total());
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u)
      frame.depth_m.push_back(static_cast<float>(image.at<uint16_t>(v, u) * scale));
  return frame;
}

}  // namespace

DepthFrame ReadDepthFrame(const std::filesystem::path& file, const std::string& unit) {
  const double scale = UnitScale(unit);
  if (file.extension() == ".png") return ReadPng(file, scale);
  const NpyArray array = ReadNumpy(file);
  if (array.shape.size() != 2 || array.dtype != "u2")
    throw Error(
        fmt::format("{}: a depth frame is a u2 array of rank 2; this is {} of rank {} "
                    "(a height map? then use --heights)",
                    file.string(), array.dtype, array.shape.size()));
  DepthFrame frame{static_cast<int>(array.shape[1]), static_cast<int>(array.shape[0]), {}};
  frame.depth_m.reserve(array.values.size());
  for (double value : array.values) frame.depth_m.push_back(static_cast<float>(value * scale));
  return frame;
}

void WriteDepthFrame(const DepthFrame& frame, const std::filesystem::path& file) {
  std::vector<uint16_t> depth_mm;
  depth_mm.reserve(frame.depth_m.size());
  for (float z : frame.depth_m) {
    SAND_CHECK(z >= 0 && z < 65.5f, z);
    depth_mm.push_back(static_cast<uint16_t>(std::lround(z * 1000)));
  }
  const auto width = static_cast<size_t>(frame.width), height = static_cast<size_t>(frame.height);
  if (file.extension() == ".npy") return WriteNpy<uint16_t>(file, depth_mm, {height, width});
  if (file.extension() != ".png")
    throw Error("cannot write depth frame " + file.string() +
                ": the name must end in .png or .npy");
  std::vector<uchar> bytes;
  if (!cv::imencode(".png", cv::Mat(frame.height, frame.width, CV_16U, depth_mm.data()), bytes))
    throw Error("cannot encode a depth frame", ErrorKind::kInternal);
  WriteFileAtomically(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

DepthFrame FuseFrames(std::span<const DepthFrame> frames) {
  if (frames.empty()) throw Error("no depth frame was given");
  DepthFrame fused = frames.front();
  for (const DepthFrame& frame : frames)
    if (frame.width != fused.width || frame.height != fused.height)
      throw Error(
          fmt::format("depth frames of different sizes cannot be fused: {} x {} and {} x {}",
                      fused.width, fused.height, frame.width, frame.height));
  if (frames.size() == 1) return fused;
  std::vector<float> readings;
  for (size_t i = 0; i < fused.depth_m.size(); ++i) {
    readings.clear();
    for (const DepthFrame& frame : frames)
      if (frame.depth_m[i] > 0) readings.push_back(frame.depth_m[i]);
    std::sort(readings.begin(), readings.end());
    const size_t n = readings.size();
    fused.depth_m[i] = n == 0 ? 0 : (readings[(n - 1) / 2] + readings[n / 2]) / 2;
  }
  return fused;
}

}  // namespace sandwright
