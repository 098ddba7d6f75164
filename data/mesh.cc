#include "data/mesh.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "data/gridding.h"

namespace sandwright {
namespace {

constexpr double kMaxCells = 16e6;
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();
// Of a cell: a centre this close to a point has its height, so that the points of an exported map meet their
// cells again after a rounding of their coordinates.
constexpr double kNear = 1e-3;
// Of a triangle: no crack where a centre lies on the edge of two.
constexpr double kOnEdge = 1e-9;

void Raise(float& height, double z) {
  if (std::isnan(height) || z > height) height = static_cast<float>(z);
}

// The triangle's height at all cell centres in it. u, v: coordinates in cells, centres at whole numbers.
void FillTriangle(const std::array<Eigen::Vector3d, 3>& corner, HeightMap& map) {
  const Eigen::Vector3d &a = corner[0], ab = corner[1] - a, ac = corner[2] - a;
  const double area = ab.x() * ac.y() - ab.y() * ac.x();
  if (std::abs(area) < 1e-12) return;  // upright: its edges belong to its neighbours too
  const auto bound = [&](int axis, bool upper, int count) {
    const auto [low, high] = std::minmax({a[axis], corner[1][axis], corner[2][axis]});
    const double at = upper ? std::floor(high + kNear) : std::ceil(low - kNear);
    return static_cast<int>(std::clamp<double>(at, upper ? -1 : 0, upper ? count - 1 : count));
  };
  const int last_row = bound(1, true, map.rows), last_column = bound(0, true, map.columns);
  for (int row = bound(1, false, map.rows); row <= last_row; ++row) {
    for (int column = bound(0, false, map.columns); column <= last_column; ++column) {
      const double du = column - a.x(), dv = row - a.y();
      const double s = (du * ac.y() - dv * ac.x()) / area, t = (ab.x() * dv - ab.y() * du) / area;
      if (s < -kOnEdge || t < -kOnEdge || s + t > 1 + kOnEdge) continue;
      Raise(map.At(row, column), a.z() + s * ab.z() + t * ac.z());
    }
  }
}

Eigen::Vector3d InCells(const Eigen::Vector3d& p, double x_m, double y_m, double cell_size_m) {
  return {(p.x() - x_m) / cell_size_m - 0.5, (p.y() - y_m) / cell_size_m - 0.5, p.z()};
}

// The cell whose centre a point lies on, if any.
std::optional<size_t> CellAt(const Eigen::Vector3d& uv, const HeightMap& map) {
  const double u = std::round(uv.x()), v = std::round(uv.y());
  if (std::abs(uv.x() - u) > kNear || std::abs(uv.y() - v) > kNear || u < 0 || v < 0 ||
      u >= map.columns || v >= map.rows)
    return std::nullopt;
  return map.Index(static_cast<int>(v), static_cast<int>(u));
}

// A grid of points as a map; false where one lies off the centres or two on one.
bool FillFromGrid(const Mesh& cloud, double x_m, double y_m, HeightMap& map) {
  for (const Eigen::Vector3d& p : cloud.points) {
    const auto cell = CellAt(InCells(p, x_m, y_m, map.cell_size_m), map);
    if (!cell || !std::isnan(map.height_m[*cell])) return false;
    map.height_m[*cell] = static_cast<float>(p.z());
  }
  return true;
}

}  // namespace

std::array<Eigen::Vector3d, 2> Bounds(const Mesh& mesh) {
  SAND_CHECK(!mesh.points.empty());
  std::array<Eigen::Vector3d, 2> bounds = {mesh.points[0], mesh.points[0]};
  for (const Eigen::Vector3d& p : mesh.points)
    bounds = {bounds[0].cwiseMin(p), bounds[1].cwiseMax(p)};
  return bounds;
}

Mesh MeshOf(const HeightMap& map, const std::string& source) {
  Mesh mesh;
  constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
  std::vector<uint32_t> index(map.size(), kNone);
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const float h = map.At(row, column);
      if (std::isnan(h)) continue;
      index[map.Index(row, column)] = static_cast<uint32_t>(mesh.points.size());
      mesh.points.emplace_back((column + 0.5) * map.cell_size_m, (row + 0.5) * map.cell_size_m, h);
    }
  }
  if (mesh.points.empty()) throw Error(source + ": the map is all hole");
  for (int row = 0; row + 1 < map.rows; ++row) {
    for (int column = 0; column + 1 < map.columns; ++column) {
      const uint32_t a = index[map.Index(row, column)], b = index[map.Index(row, column + 1)],
                     c = index[map.Index(row + 1, column + 1)],
                     d = index[map.Index(row + 1, column)];
      for (const auto& triangle : {std::array{a, b, c}, std::array{a, c, d}})
        if (std::ranges::count(triangle, kNone) == 0) mesh.triangles.push_back(triangle);
    }
  }
  return mesh;
}

void FillFromAbove(const Mesh& mesh_m, double x_m, double y_m, HeightMap& map) {
  std::fill(map.height_m.begin(), map.height_m.end(), kNothing);
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3d& p : mesh_m.points)
    points.push_back(InCells(p, x_m, y_m, map.cell_size_m));
  for (const auto& t : mesh_m.triangles) FillTriangle({points[t[0]], points[t[1]], points[t[2]]}, map);
  for (const Eigen::Vector3d& p : points)
    if (const auto cell = CellAt(p, map)) Raise(map.height_m[*cell], p.z());
}

HeightMap HeightsOf(const Mesh& mesh_m, double cell_size_m, const std::string& source) {
  const auto [low, high] = Bounds(mesh_m);
  const auto count = [&](int axis) { return std::floor((high[axis] - low[axis]) / cell_size_m + kNear) + 1; };
  const double columns = count(0), rows = count(1);
  if (rows * columns < 2 || rows * columns > kMaxCells)
    throw Error(fmt::format("{}: {:.4g} x {:.4g} m make {:.0f} x {:.0f} cells of {:g} m; allowed: 2 to 16 million "
                            "cells. Are --unit and --cell-size right?",
                            source, high.x() - low.x(), high.y() - low.y(), columns, rows, cell_size_m));
  HeightMap map(static_cast<int>(rows), static_cast<int>(columns), cell_size_m, kNothing,
                Datum::kRelative);
  const double x_m = low.x() - cell_size_m / 2, y_m = low.y() - cell_size_m / 2;
  if (!mesh_m.triangles.empty()) {
    FillFromAbove(mesh_m, x_m, y_m, map);
  } else if (!FillFromGrid(mesh_m, x_m, y_m, map)) {
    std::vector<Eigen::Vector3f> points;
    for (const Eigen::Vector3d& p : mesh_m.points)
      points.push_back((p - Eigen::Vector3d(x_m, y_m, 0)).cast<float>());
    map = GridPoints(points, map.rows, map.columns, cell_size_m, 2 * cell_size_m);
    for (size_t i = 0; i < map.size(); ++i)
      if (!map.valid[i]) map.height_m[i] = kNothing;
    map.valid.clear();
  }
  if (std::ranges::all_of(map.height_m, [](float h) { return std::isnan(h); }))
    throw Error(source + ": seen from above it covers no cell");
  return map;
}

}  // namespace sandwright
