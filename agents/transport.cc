#include "agents/transport.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace sandwright {
namespace {

constexpr double kMostBins = 24;  // in a row: the transport problem grows with their fourth power
constexpr double kLeast_m3 = 1e-12;

struct Bin {
  double above_m3 = 0;  // sand above the goal less sand missing
  Eigen::Vector2d places_m = Eigen::Vector2d::Zero();  // sum over its counted cells
  double cells = 0;
  Eigen::Vector2d middle_m() const { return places_m / cells; }
};

// As cv::EMD wants it: weight, x, y in rows, in cm^3 and m.
cv::Mat Signature(const std::vector<Bin>& bins) {
  cv::Mat signature(static_cast<int>(bins.size()), 3, CV_32F);
  for (int i = 0; i < signature.rows; ++i) {
    const Bin& bin = bins[static_cast<size_t>(i)];
    signature.at<float>(i, 0) = static_cast<float>(1e6 * std::abs(bin.above_m3));
    signature.at<float>(i, 1) = static_cast<float>(bin.middle_m().x());
    signature.at<float>(i, 2) = static_cast<float>(bin.middle_m().y());
  }
  return signature;
}

}  // namespace

std::vector<SandFlow> OptimalTransport(const TaskView& view, double bin_m) {
  const HeightMap& map = view.sensed;
  const Region& region = view.region;
  bin_m = std::max(bin_m, std::max(region.width_m, region.depth_m) / kMostBins);
  const int columns = std::max(1, static_cast<int>(std::ceil(region.width_m / bin_m - 1e-6)));
  const int rows = std::max(1, static_cast<int>(std::ceil(region.depth_m / bin_m - 1e-6)));
  std::vector<Bin> bins(static_cast<size_t>(rows * columns));
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const size_t cell = map.Index(row, column);
      if (!view.goal.mask[cell]) continue;
      const Eigen::Vector2d p((column + 0.5) * map.cell_size_m, (row + 0.5) * map.cell_size_m);
      const int i = std::clamp(static_cast<int>((p.y() - region.y_m) / bin_m), 0, rows - 1);
      const int j = std::clamp(static_cast<int>((p.x() - region.x_m) / bin_m), 0, columns - 1);
      Bin& bin = bins[static_cast<size_t>(i * columns + j)];
      bin.above_m3 += (static_cast<double>(map.height_m[cell]) - view.goal.height_m[cell]) *
                      map.cell_size_m * map.cell_size_m;
      bin.places_m += p;
      ++bin.cells;
    }
  }
  std::vector<Bin> surplus, deficit;
  for (const Bin& bin : bins) {
    if (std::abs(bin.above_m3) > kLeast_m3) (bin.above_m3 > 0 ? surplus : deficit).push_back(bin);
  }
  if (surplus.empty() || deficit.empty()) return {};
  cv::Mat flow;
  cv::EMD(Signature(surplus), Signature(deficit), cv::DIST_L2, cv::noArray(), nullptr, flow);
  std::vector<SandFlow> flows;
  for (int i = 0; i < flow.rows; ++i) {
    for (int j = 0; j < flow.cols; ++j) {
      if (flow.at<float>(i, j) <= 0) continue;
      flows.push_back({surplus[static_cast<size_t>(i)].middle_m(),
                       deficit[static_cast<size_t>(j)].middle_m(), 1e-6 * flow.at<float>(i, j)});
    }
  }
  return flows;
}

}  // namespace sandwright
