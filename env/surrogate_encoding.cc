#include "env/surrogate_encoding.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sandwright {
namespace {

constexpr double kHeightScale_m = 0.020, kLengthScale_m = 0.100, kChangeScale_m = 0.010;
constexpr double kNearFade_m = 0.040, kEndFade_m = 0.060, kWallFade_m = 0.030;

struct PathPoint {
  double x_m, y_m, z_m, cos_yaw, sin_yaw, remaining_m;
};

// The path at steps of at most a cell and 0.1 rad, with the way left to its end.
std::vector<PathPoint> Densify(const ToolPath& path, double step_m) {
  std::vector<PathPoint> points;
  const auto add = [&](const BladePose& p) {
    points.push_back({p.x_m, p.y_m, p.z_m, std::cos(p.yaw_rad), std::sin(p.yaw_rad), 0});
  };
  add(path.front());
  for (size_t i = 1; i < path.size(); ++i) {
    const BladePose &a = path[i - 1], &b = path[i];
    const double length_m = std::hypot(b.x_m - a.x_m, b.y_m - a.y_m);
    const double parts =
        std::ceil(std::max(length_m / step_m, std::abs(b.yaw_rad - a.yaw_rad) / 0.1));
    for (int k = 1; k <= static_cast<int>(parts); ++k) {
      const double t = k / parts;
      add({a.x_m + t * (b.x_m - a.x_m), a.y_m + t * (b.y_m - a.y_m), a.z_m + t * (b.z_m - a.z_m),
           a.yaw_rad + t * (b.yaw_rad - a.yaw_rad)});
    }
  }
  for (size_t i = points.size() - 1; i-- > 0;)
    points[i].remaining_m =
        points[i + 1].remaining_m +
        std::hypot(points[i + 1].x_m - points[i].x_m, points[i + 1].y_m - points[i].y_m);
  return points;
}

// The lowest height of the blade's edge over each cell of the window; infinity where it never was.
// A cell counts as passed when its centre is within the blade's footprint grown by half a cell.
std::vector<float> LowestPassage(const std::vector<PathPoint>& points, const CellRect& window,
                                 double cell_m, const Blade& blade) {
  const double half_width_m = blade.width_m / 2 + cell_m / 2;
  const double half_thickness_m = blade.thickness_m / 2 + cell_m / 2;
  const double reach_m = std::hypot(half_width_m, half_thickness_m);
  std::vector<float> lowest(
      static_cast<size_t>(window.rows()) * static_cast<size_t>(window.columns()),
      std::numeric_limits<float>::infinity());
  const auto first = [&](double low_m, int bound) {
    return std::max(static_cast<int>(std::floor(low_m / cell_m)), bound);
  };
  const auto last = [&](double high_m, int bound) {
    return std::min(static_cast<int>(std::ceil(high_m / cell_m)), bound);
  };
  for (const PathPoint& p : points) {
    const int row1 = last(p.y_m + reach_m, window.row1),
              column1 = last(p.x_m + reach_m, window.column1);
    for (int row = first(p.y_m - reach_m, window.row0); row < row1; ++row) {
      for (int column = first(p.x_m - reach_m, window.column0); column < column1; ++column) {
        const double dx = (column + 0.5) * cell_m - p.x_m, dy = (row + 0.5) * cell_m - p.y_m;
        if (std::abs(dx * p.cos_yaw + dy * p.sin_yaw) > half_thickness_m ||
            std::abs(dy * p.cos_yaw - dx * p.sin_yaw) > half_width_m)
          continue;
        float& z =
            lowest[static_cast<size_t>(row - window.row0) * static_cast<size_t>(window.columns()) +
                   static_cast<size_t>(column - window.column0)];
        z = std::min(z, static_cast<float>(p.z_m));
      }
    }
  }
  return lowest;
}

// The point nearest to (x, y); the later one of two equally near.
const PathPoint& Nearest(const std::vector<PathPoint>& points, double x_m, double y_m,
                         double& distance_m) {
  const PathPoint* nearest = nullptr;
  double best = std::numeric_limits<double>::infinity();
  for (const PathPoint& p : points) {
    const double squared = (x_m - p.x_m) * (x_m - p.x_m) + (y_m - p.y_m) * (y_m - p.y_m);
    if (squared <= best) best = squared, nearest = &p;
  }
  distance_m = std::sqrt(best);
  return *nearest;
}

double MeanHeight(const HeightMap& map, const CellRect& rect) {
  double sum = 0;
  for (int row = rect.row0; row < rect.row1; ++row) {
    for (int column = rect.column0; column < rect.column1; ++column) sum += map.At(row, column);
  }
  return sum / (static_cast<double>(rect.rows()) * rect.columns());
}

}  // namespace

SurrogateInput EncodeStroke(const HeightMap& before, const HeightMap& predicted,
                            const ToolPath& path, const Blade& blade, int multiple) {
  SAND_CHECK(before.SameGrid(predicted) && multiple > 0, multiple);
  SurrogateInput input;
  input.window = StrokeWindow(before, path);
  if (input.window.empty()) return input;
  const CellRect& window = input.window;
  input.rows = (window.rows() + multiple - 1) / multiple * multiple;
  input.columns = (window.columns() + multiple - 1) / multiple * multiple;
  const size_t plane = static_cast<size_t>(input.rows) * static_cast<size_t>(input.columns);
  input.channels.assign(kSurrogateChannelCount * plane, 0.0f);

  const double cell_m = before.cell_size_m;
  const std::vector<PathPoint> points = Densify(path, cell_m);
  const std::vector<float> lowest = LowestPassage(points, window, cell_m, blade);
  const double mean_m = MeanHeight(before, window);
  const PathPoint& end = points.back();
  size_t cell = 0;
  for (int row = window.row0; row < window.row1; ++row) {
    for (int column = window.column0; column < window.column1; ++column, ++cell) {
      const double x = (column + 0.5) * cell_m, y = (row + 0.5) * cell_m,
                   h = before.At(row, column);
      double distance_m;
      const PathPoint& nearest = Nearest(points, x, y, distance_m);
      const double near = std::exp(-distance_m / kNearFade_m);
      const double ex = x - end.x_m, ey = y - end.y_m;
      const double end_near = std::exp(-std::hypot(ex, ey) / kEndFade_m);
      const double wall_m = std::min({x, y, before.width_m() - x, before.depth_m() - y});
      const double z = lowest[cell];
      const bool passed = std::isfinite(z);
      const std::array<double, kSurrogateChannelCount> values = {
          1,
          (h - mean_m) / kHeightScale_m,
          passed ? std::max(h - z, 0.0) / kHeightScale_m : 0,
          passed ? (z - mean_m) / kHeightScale_m : 0,
          nearest.cos_yaw * near,
          nearest.sin_yaw * near,
          nearest.remaining_m / kLengthScale_m * near,
          near,
          (ex * end.cos_yaw + ey * end.sin_yaw) / kLengthScale_m * end_near,
          end_near,
          std::exp(-wall_m / kWallFade_m),
          (predicted.At(row, column) - h) / kChangeScale_m};
      const size_t at =
          static_cast<size_t>(row - window.row0) * static_cast<size_t>(input.columns) +
          static_cast<size_t>(column - window.column0);
      for (size_t c = 0; c < values.size(); ++c)
        input.channels[c * plane + at] = static_cast<float>(values[c]);
    }
  }
  return input;
}

}  // namespace sandwright
