#include "env/surrogate_encoding.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

// Built for several instruction sets; the loader takes the best that the machine has.
#ifdef __x86_64__
#define SAND_CLONES __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define SAND_CLONES
#endif

namespace sandwright {
namespace {

constexpr float kHeightScale_m = 0.020f, kLengthScale_m = 0.100f, kChangeScale_m = 0.010f;
constexpr float kNearFade_m = 0.040f, kEndFade_m = 0.060f, kWallFade_m = 0.030f;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The path at steps of at most a cell and 0.1 rad, with the way left to its end. Positions are
// relative to the window's corner.
struct PathPoints {
  std::vector<float> x_m, y_m, z_m, cos_yaw, sin_yaw, remaining_m;
  int count() const { return static_cast<int>(x_m.size()); }
};

PathPoints Densify(const ToolPath& path, double step_m, double corner_x_m, double corner_y_m) {
  PathPoints points;
  const auto add = [&](double x_m, double y_m, double z_m, double yaw_rad) {
    points.x_m.push_back(static_cast<float>(x_m - corner_x_m));
    points.y_m.push_back(static_cast<float>(y_m - corner_y_m));
    points.z_m.push_back(static_cast<float>(z_m));
    points.cos_yaw.push_back(static_cast<float>(std::cos(yaw_rad)));
    points.sin_yaw.push_back(static_cast<float>(std::sin(yaw_rad)));
  };
  add(path[0].x_m, path[0].y_m, path[0].z_m, path[0].yaw_rad);
  for (size_t i = 1; i < path.size(); ++i) {
    const BladePose &a = path[i - 1], &b = path[i];
    const double length_m = std::hypot(b.x_m - a.x_m, b.y_m - a.y_m);
    const double parts =
        std::ceil(std::max(length_m / step_m, std::abs(b.yaw_rad - a.yaw_rad) / 0.1));
    for (int k = 1; k <= static_cast<int>(parts); ++k) {
      const double t = k / parts;
      add(a.x_m + t * (b.x_m - a.x_m), a.y_m + t * (b.y_m - a.y_m), a.z_m + t * (b.z_m - a.z_m),
          a.yaw_rad + t * (b.yaw_rad - a.yaw_rad));
    }
  }
  points.remaining_m.assign(points.x_m.size(), 0.0f);
  for (size_t i = points.x_m.size() - 1; i-- > 0;)
    points.remaining_m[i] =
        points.remaining_m[i + 1] +
        std::hypot(points.x_m[i + 1] - points.x_m[i], points.y_m[i + 1] - points.y_m[i]);
  return points;
}

// Lowers lowest[i] to z_m where the centre of column `first + i` lies in the blade's footprint.
SAND_CLONES void LowerRow(float* lowest, int first, int count, float cell_m, float x_m, float dy_m,
                          float z_m, float cos_yaw, float sin_yaw, float half_thickness_m,
                          float half_width_m) {
  for (int i = 0; i < count; ++i) {
    const float dx_m = (static_cast<float>(first + i) + 0.5f) * cell_m - x_m;
    const bool under = (std::abs(dx_m * cos_yaw + dy_m * sin_yaw) <= half_thickness_m) &
                       (std::abs(dy_m * cos_yaw - dx_m * sin_yaw) <= half_width_m);
    lowest[i] = under ? std::min(lowest[i], z_m) : lowest[i];
  }
}

// The lowest height of the blade's edge over each cell of the window; infinity where it never was.
// A cell counts as passed when its centre is within the blade's footprint grown by half a cell.
std::vector<float> LowestPassage(const PathPoints& points, int rows, int columns, float cell_m,
                                 const Blade& blade) {
  const float half_width_m = static_cast<float>(blade.width_m) / 2 + cell_m / 2;
  const float half_thickness_m = static_cast<float>(blade.thickness_m) / 2 + cell_m / 2;
  const float reach_m = std::hypot(half_width_m, half_thickness_m);
  std::vector<float> lowest(static_cast<size_t>(rows) * static_cast<size_t>(columns), kInfinity);
  const auto first = [&](float low_m) {
    return std::max(static_cast<int>(std::floor(low_m / cell_m)), 0);
  };
  const auto last = [&](float high_m, int bound) {
    return std::min(static_cast<int>(std::ceil(high_m / cell_m)), bound);
  };
  for (size_t k = 0; k < points.x_m.size(); ++k) {
    const float x_m = points.x_m[k], y_m = points.y_m[k];
    const int column0 = first(x_m - reach_m), column1 = last(x_m + reach_m, columns);
    const int row1 = last(y_m + reach_m, rows);
    for (int row = first(y_m - reach_m); row < row1; ++row) {
      const float dy_m = (static_cast<float>(row) + 0.5f) * cell_m - y_m;
      LowerRow(&lowest[static_cast<size_t>(row * columns + column0)], column0, column1 - column0,
               cell_m, x_m, dy_m, points.z_m[k], points.cos_yaw[k], points.sin_yaw[k],
               half_thickness_m, half_width_m);
    }
  }
  return lowest;
}

double MeanHeight(const HeightMap& map, const CellRect& rect) {
  double sum = 0;
  for (int row = rect.row0; row < rect.row1; ++row) {
    for (int column = rect.column0; column < rect.column1; ++column) sum += map.At(row, column);
  }
  return sum / (static_cast<double>(rect.rows()) * rect.columns());
}

// e^x for x <= 0, to a few units in the last place; vectorised, unlike the library's.
[[gnu::always_inline]] inline float Exp(float x) {
  const float t = std::max(x, -80.0f) * 1.44269504f;
  const auto whole = static_cast<int32_t>(t - 0.5f);
  const float f = t - static_cast<float>(whole);  // -0.5 .. 0.5; below: 2^f by its series
  const float series =
      1 + f * (0.693147181f +
               f * (0.240226507f +
                    f * (0.0555041087f +
                         f * (0.00961812911f + f * (0.00133335581f + f * 0.000154035304f)))));
  return series * std::bit_cast<float>((whole + 127) << 23);
}

// For each column the nearest point of the path (the later one of two equally near) and the squared
// distance to it.
SAND_CLONES void NearestInRow(const float* x_m, int columns, const float* points_x_m,
                              const float* points_y_m, int points, float y_m, float* squared_m2,
                              int32_t* nearest) {
  for (int i = 0; i < columns; ++i) squared_m2[i] = kInfinity;
  for (int k = 0; k < points; ++k) {
    const float dy_m = y_m - points_y_m[k], px_m = points_x_m[k], dy_m2 = dy_m * dy_m;
    for (int i = 0; i < columns; ++i) {
      const float dx_m = x_m[i] - px_m, candidate_m2 = dx_m * dx_m + dy_m2;
      const bool closer = candidate_m2 <= squared_m2[i];
      squared_m2[i] = closer ? candidate_m2 : squared_m2[i];
      nearest[i] = closer ? k : nearest[i];
    }
  }
}

// One row of the window. Arrays are by column.
struct Row {
  const float *x_m, *before_m, *predicted_m, *lowest_m, *wall_x_m;
  const float* squared_m2;
  const int32_t* nearest;
  float y_m, wall_y_m, mean_m;
  float end_x_m, end_y_m, end_cos, end_sin;
  float reach_m, ahead_m;  // see EncodeStroke
  const float *cos_yaw, *sin_yaw, *remaining_m;
};

// Fills the row's channels, `plane` values apart.
SAND_CLONES void EncodeRow(const Row& row, int columns, float* __restrict out, size_t plane,
                           uint8_t* __restrict active) {
#pragma GCC ivdep
  for (int i = 0; i < columns; ++i) {
    const int32_t k = row.nearest[i];
    const float h_m = row.before_m[i], z_m = row.lowest_m[i];
    const bool passed = z_m < kInfinity;
    const float near = Exp(-std::sqrt(row.squared_m2[i]) / kNearFade_m);
    const float ex_m = row.x_m[i] - row.end_x_m, ey_m = row.y_m - row.end_y_m;
    const float along_m = ex_m * row.end_cos + ey_m * row.end_sin;
    const float end_m2 = ex_m * ex_m + ey_m * ey_m;
    const float end_near = Exp(-std::sqrt(end_m2) / kEndFade_m);
    // Squared distance to the way ahead: a straight piece from the end on.
    const float on_piece_m = std::min(std::max(along_m, 0.0f), row.ahead_m);
    const float ahead_m2 =
        end_m2 - along_m * along_m + (along_m - on_piece_m) * (along_m - on_piece_m);
    const bool reached =
        row.reach_m <= 0 || std::min(row.squared_m2[i], ahead_m2) <= row.reach_m * row.reach_m;
    const float on = reached ? 1.0f : 0.0f;
    active[i] = reached;
    out[i] = on;
    out[plane + i] = on * (h_m - row.mean_m) / kHeightScale_m;
    out[2 * plane + i] = passed ? std::max(h_m - z_m, 0.0f) / kHeightScale_m : 0.0f;
    out[3 * plane + i] = passed ? (z_m - row.mean_m) / kHeightScale_m : 0.0f;
    out[4 * plane + i] = on * row.cos_yaw[k] * near;
    out[5 * plane + i] = on * row.sin_yaw[k] * near;
    out[6 * plane + i] = on * row.remaining_m[k] / kLengthScale_m * near;
    out[7 * plane + i] = on * near;
    out[8 * plane + i] = on * along_m / kLengthScale_m * end_near;
    out[9 * plane + i] = on * end_near;
    out[10 * plane + i] = on * Exp(-std::min(row.wall_x_m[i], row.wall_y_m) / kWallFade_m);
    out[11 * plane + i] = on * (row.predicted_m[i] - h_m) / kChangeScale_m;
  }
}

}  // namespace

SurrogateInput EncodeStroke(const HeightMap& before, const HeightMap& predicted,
                            const ToolPath& path, const Blade& blade, int multiple,
                            double reach_m) {
  SAND_CHECK(before.SameGrid(predicted) && multiple > 0, multiple);
  SurrogateInput input;
  input.window = StrokeWindow(before, path);
  if (input.window.empty()) return input;
  const CellRect& window = input.window;
  const int columns = window.columns();
  input.rows = (window.rows() + multiple - 1) / multiple * multiple;
  input.columns = (columns + multiple - 1) / multiple * multiple;
  const size_t plane = static_cast<size_t>(input.rows) * static_cast<size_t>(input.columns);
  input.channels.assign(kSurrogateChannelCount * plane, 0.0f);
  input.active.assign(plane, reach_m > 0 ? 0 : 1);

  const double cell_m = before.cell_size_m;
  const auto cell = static_cast<float>(cell_m);
  const double corner_x_m = window.column0 * cell_m, corner_y_m = window.row0 * cell_m;
  const PathPoints points = Densify(path, cell_m, corner_x_m, corner_y_m);
  const std::vector<float> lowest = LowestPassage(points, window.rows(), columns, cell, blade);
  std::vector<float> x_m, wall_x_m, squared_m2(static_cast<size_t>(columns));
  std::vector<int32_t> nearest(static_cast<size_t>(columns));
  for (int i = 0; i < columns; ++i) {
    x_m.push_back((static_cast<float>(i) + 0.5f) * cell);
    const double x = corner_x_m + (i + 0.5) * cell_m;
    wall_x_m.push_back(static_cast<float>(std::min(x, before.width_m() - x)));
  }
  Row row{.x_m = x_m.data(),
          .before_m = nullptr,
          .predicted_m = nullptr,
          .lowest_m = nullptr,
          .wall_x_m = wall_x_m.data(),
          .squared_m2 = squared_m2.data(),
          .nearest = nearest.data(),
          .y_m = 0,
          .wall_y_m = 0,
          .mean_m = static_cast<float>(MeanHeight(before, window)),
          .end_x_m = points.x_m.back(),
          .end_y_m = points.y_m.back(),
          .end_cos = points.cos_yaw.back(),
          .end_sin = points.sin_yaw.back(),
          .reach_m = static_cast<float>(reach_m),
          .ahead_m = static_cast<float>(std::max(kWindowAhead_m - reach_m, 0.0)),
          .cos_yaw = points.cos_yaw.data(),
          .sin_yaw = points.sin_yaw.data(),
          .remaining_m = points.remaining_m.data()};
  for (int j = 0; j < window.rows(); ++j) {
    const size_t from = before.Index(window.row0 + j, window.column0);
    const size_t to = static_cast<size_t>(j) * static_cast<size_t>(input.columns);
    const double y = corner_y_m + (j + 0.5) * cell_m;
    row.y_m = (static_cast<float>(j) + 0.5f) * cell;
    row.wall_y_m = static_cast<float>(std::min(y, before.depth_m() - y));
    row.before_m = &before.height_m[from];
    row.predicted_m = &predicted.height_m[from];
    row.lowest_m = &lowest[static_cast<size_t>(j * columns)];
    NearestInRow(x_m.data(), columns, points.x_m.data(), points.y_m.data(), points.count(), row.y_m,
                 squared_m2.data(), nearest.data());
    EncodeRow(row, columns, &input.channels[to], plane, &input.active[to]);
  }
  return input;
}

}  // namespace sandwright
