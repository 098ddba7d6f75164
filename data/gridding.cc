#include "data/gridding.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace sandwright {
namespace {

// Weighted moments of the points near one cell, about its centre.
struct Moments {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  int points = 0;
};

cv::Mat SeenMask(const HeightMap& map) {
  cv::Mat seen(map.rows, map.columns, CV_8U);
  for (int row = 0; row < map.rows; ++row)
    for (int column = 0; column < map.columns; ++column)
      seen.at<uchar>(row, column) = map.valid[map.Index(row, column)] ? 1 : 0;
  return seen;
}

}  // namespace

HeightMap GridPoints(const std::vector<Eigen::Vector3f>& points_m, int rows, int columns,
                     double cell_size_m, double reach_m) {
  HeightMap map(rows, columns, cell_size_m, 0, Datum::kRelative);
  map.valid.assign(map.size(), 0);
  std::vector<Moments> cells(map.size());
  for (const Eigen::Vector3f& point : points_m) {
    const double x = point.x(), y = point.y(), z = point.z();
    const auto first = [&](double at) {
      return std::max(0, static_cast<int>(std::ceil((at - reach_m) / cell_size_m - 0.5)));
    };
    const auto last = [&](double at, int count) {
      return std::min(count - 1, static_cast<int>(std::floor((at + reach_m) / cell_size_m - 0.5)));
    };
    for (int row = first(y); row <= last(y, rows); ++row) {
      for (int column = first(x); column <= last(x, columns); ++column) {
        const double dx = x - (column + 0.5) * cell_size_m, dy = y - (row + 0.5) * cell_size_m;
        const double weight = (1 - std::abs(dx) / reach_m) * (1 - std::abs(dy) / reach_m);
        Moments& cell = cells[map.Index(row, column)];
        const Eigen::Vector3d basis(1, dx, dy);
        cell.normal += weight * basis * basis.transpose();
        cell.right += weight * z * basis;
        ++cell.points;
      }
    }
  }
  for (size_t i = 0; i < cells.size(); ++i) {
    Moments& cell = cells[i];
    if (cell.points < 3 || cell.normal(0, 0) < 0.05) continue;
    // A little stiffness keeps the plane level where all points lie on one side or in a line.
    const double stiffness = 0.02 * cell.normal(0, 0) * reach_m * reach_m;
    cell.normal(1, 1) += stiffness;
    cell.normal(2, 2) += stiffness;
    map.height_m[i] = static_cast<float>(cell.normal.ldlt().solve(cell.right).x());
    map.valid[i] = 1;
  }
  return map;
}

Holes MeasureHoles(const HeightMap& map) {
  const auto seen =
      static_cast<double>(std::ranges::count_if(map.valid, [](uint8_t v) { return v; }));
  Holes holes;
  holes.share = 1 - seen / static_cast<double>(map.size());
  if (seen == 0) {
    holes.largest_m = std::max(map.width_m(), map.depth_m());
  } else if (holes.share > 0) {
    cv::Mat distance;
    cv::distanceTransform(1 - SeenMask(map), distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    double largest = 0;
    cv::minMaxLoc(distance, nullptr, &largest);
    holes.largest_m = largest * map.cell_size_m;
  }
  return holes;
}

void FillHoles(HeightMap& map) {
  const auto known = std::ranges::count_if(map.valid, [](uint8_t v) { return v; });
  SAND_CHECK(known > 0, known);
  std::vector<uint8_t> filled = map.valid;
  std::vector<size_t> holes;  // in the order of the rings around the seen cells
  const auto mean_of_neighbours = [&](size_t i, const std::vector<uint8_t>& use) {
    const int row = static_cast<int>(i) / map.columns, column = static_cast<int>(i) % map.columns;
    double sum = 0;
    int count = 0;
    for (const auto& [dr, dc] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      if (row + dr < 0 || row + dr >= map.rows || column + dc < 0 || column + dc >= map.columns)
        continue;
      const size_t k = map.Index(row + dr, column + dc);
      if (use[k]) sum += map.height_m[k], ++count;
    }
    return std::pair{count > 0 ? sum / count : 0.0, count};
  };
  for (bool grown = true; grown;) {
    grown = false;
    const std::vector<uint8_t> before = filled;
    for (size_t i = 0; i < map.size(); ++i) {
      if (before[i]) continue;
      const auto [mean, count] = mean_of_neighbours(i, before);
      if (count == 0) continue;
      map.height_m[i] = static_cast<float>(mean);
      filled[i] = 1;
      holes.push_back(i);
      grown = true;
    }
  }
  // Rings leave kinks; relaxing turns them into the membrane.
  for (int sweep = 0; sweep < 200 && !holes.empty(); ++sweep)
    for (size_t i : holes)
      map.height_m[i] = static_cast<float>(mean_of_neighbours(i, filled).first);
}

}  // namespace sandwright
