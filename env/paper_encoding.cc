#include "env/paper_encoding.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "data/picture.h"
#include "env/blade_path.h"

namespace sandwright {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

size_t PixelIndex(int row, int column) { return static_cast<size_t>(row * kPaperPixels + column); }

template <class Body>
void ForEachPixel(const Body& body) {
  for (int row = 0; row < kPaperPixels; ++row) {
    for (int column = 0; column < kPaperPixels; ++column)
      body(PixelIndex(row, column), row, column);
  }
}

bool Seen(const HeightMap& map, const Eigen::Vector2d& p_m) {
  if (map.valid.empty()) return true;
  const int row = std::min(static_cast<int>(p_m.y() / map.cell_size_m), map.rows - 1),
            column = std::min(static_cast<int>(p_m.x() / map.cell_size_m), map.columns - 1);
  return map.valid[map.Index(row, column)] != 0;
}

// Lowest height of the blade's edge over each pixel [m]; infinity where it never was.
std::vector<double> LowestPassage(const PaperFrame& frame, const ToolPath& path,
                                  const Blade& blade) {
  std::vector<double> lowest_m(kPaperCount, kInfinity);
  const double half_width = blade.width_m / 2 / kPaperPixel_m + 0.5;
  const double half_thickness = blade.thickness_m / 2 / kPaperPixel_m + 0.5;
  const double reach = std::hypot(half_width, half_thickness);
  const auto clip = [](double pixel) {
    return static_cast<int>(std::clamp<double>(pixel, 0, kPaperPixels));
  };
  for (const BladePose& pose : EqualSteps(path, kPaperPixel_m, blade)) {
    const Eigen::Vector2d at = frame.ToPicture(pose.x_m, pose.y_m);
    const Eigen::Vector2d normal =
        frame.ToPicture(pose.x_m + kPaperPixel_m * std::cos(pose.yaw_rad),
                        pose.y_m + kPaperPixel_m * std::sin(pose.yaw_rad)) -
        at;
    for (int row = clip(at.x() - reach); row < clip(at.x() + reach + 1); ++row) {
      for (int column = clip(at.y() - reach); column < clip(at.y() + reach + 1); ++column) {
        const Eigen::Vector2d off(row + 0.5 - at.x(), column + 0.5 - at.y());
        const double along = off.dot(normal), across = off.x() * normal.y() - off.y() * normal.x();
        if (std::abs(along) > half_thickness || std::abs(across) > half_width) continue;
        double& lowest = lowest_m[PixelIndex(row, column)];
        lowest = std::min(lowest, pose.z_m);
      }
    }
  }
  return lowest_m;
}

}  // namespace

PaperFrame::PaperFrame(const ToolPath& path) {
  SAND_CHECK(!path.empty());
  const BladePose &first = path.front(), &last = path.back();
  middle_m = {(first.x_m + last.x_m) / 2, (first.y_m + last.y_m) / 2};
  const Eigen::Vector2d way_m(last.x_m - first.x_m, last.y_m - first.y_m);
  down = way_m.norm() > 1e-6 ? way_m.normalized()
                             : Eigen::Vector2d(std::cos(last.yaw_rad), std::sin(last.yaw_rad));
}

Eigen::Vector2d PaperFrame::ToBox(double row, double column) const {
  const double along_m = (row - kPaperPixels / 2.0) * kPaperPixel_m,
               across_m = (column - kPaperPixels / 2.0) * kPaperPixel_m;
  return middle_m + along_m * down + across_m * Eigen::Vector2d(-down.y(), down.x());
}

Eigen::Vector2d PaperFrame::ToPicture(double x_m, double y_m) const {
  const Eigen::Vector2d off = (Eigen::Vector2d(x_m, y_m) - middle_m) / kPaperPixel_m;
  return {kPaperPixels / 2.0 + off.dot(down),
          kPaperPixels / 2.0 + off.y() * down.x() - off.x() * down.y()};
}

bool InsideWalls(const HeightMap& map, const Eigen::Vector2d& p_m) {
  return p_m.x() >= 0 && p_m.y() >= 0 && p_m.x() < map.width_m() && p_m.y() < map.depth_m();
}

uint8_t PaperLevel(double height_m) {
  return static_cast<uint8_t>(std::clamp(std::round(height_m / kPaperLevel_m), 0.0, 255.0));
}

std::optional<PaperInput> EncodePaperInput(const HeightMap& before, const ToolPath& path,
                                           const Blade& blade) {
  PaperInput input{PaperFrame(path), kInfinity, {}, {}, {}, {}};
  const std::vector<double> lowest_m = LowestPassage(input.frame, path, blade);
  std::vector<double> heights_m(kPaperCount);
  input.counts.assign(kPaperCount, 0);
  ForEachPixel([&](size_t i, int row, int column) {
    const Eigen::Vector2d p_m = input.frame.ToBox(row + 0.5, column + 0.5);
    heights_m[i] = HeightAt(before, p_m.x(), p_m.y());
    if (!InsideWalls(before, p_m)) return;
    input.counts[i] = Seen(before, p_m);
    input.zero_m = std::min({input.zero_m, heights_m[i], lowest_m[i]});
  });
  if (input.zero_m == kInfinity) return std::nullopt;
  for (size_t i = 0; i < kPaperCount; ++i) {
    const bool passed = lowest_m[i] < kInfinity;
    input.height.push_back(PaperLevel(heights_m[i] - input.zero_m));
    input.path.push_back(passed ? 255 : 0);
    input.depth.push_back(passed ? PaperLevel(heights_m[i] - lowest_m[i]) : 0);
  }
  return input;
}

PaperPlane EncodePaperHeight(const HeightMap& map, const PaperInput& input) {
  PaperPlane plane(kPaperCount);
  ForEachPixel([&](size_t i, int row, int column) {
    const Eigen::Vector2d p_m = input.frame.ToBox(row + 0.5, column + 0.5);
    plane[i] = PaperLevel(HeightAt(map, p_m.x(), p_m.y()) - input.zero_m);
  });
  return plane;
}

CellRect PastePaperChange(const PaperInput& input, const PaperPlane& predicted, HeightMap& map) {
  SAND_CHECK(predicted.size() == kPaperCount, predicted.size());
  HeightMap change(kPaperPixels, kPaperPixels, 1.0);  // in pixels: HeightAt(map, column, row)
  for (size_t i = 0; i < kPaperCount; ++i)
    change.height_m[i] =
        static_cast<float>(kPaperLevel_m * (int{predicted[i]} - int{input.height[i]}));
  const int parts = std::max(static_cast<int>(std::lround(map.cell_size_m / kPaperPixel_m)), 1);
  CellRect held;
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const auto place = [&](double part_y, double part_x) {
        return input.frame.ToPicture((column + part_x) * map.cell_size_m,
                                     (row + part_y) * map.cell_size_m);
      };
      const Eigen::Vector2d centre = place(0.5, 0.5);
      if (centre.minCoeff() < 0 || centre.maxCoeff() >= kPaperPixels) continue;
      held = Union(held, {row, column, row + 1, column + 1});
      double sum_m = 0;
      for (int part = 0; part < parts * parts; ++part) {
        const Eigen::Vector2d at =
            place((part / parts + 0.5) / parts, (part % parts + 0.5) / parts);
        sum_m += HeightAt(change, at.y(), at.x());
      }
      float& height_m = map.At(row, column);
      const auto changed_m = static_cast<float>(height_m + sum_m / (parts * parts));
      height_m =
          map.datum == Datum::kFloor ? std::max(changed_m, std::min(height_m, 0.0f)) : changed_m;
    }
  }
  return held;
}

void WritePaperPair(const PaperInput& input, const PaperPlane& after,
                    const std::filesystem::path& file) {
  SAND_CHECK(after.size() == kPaperCount, after.size());
  cv::Mat bgr(kPaperPixels, 2 * kPaperPixels, CV_8UC3);
  ForEachPixel([&](size_t i, int row, int column) {
    bgr.at<cv::Vec3b>(row, column) = {input.depth[i], input.path[i], input.height[i]};
    bgr.at<cv::Vec3b>(row, kPaperPixels + column) = {after[i], after[i], after[i]};
  });
  WritePicture(bgr, file);
}

}  // namespace sandwright
