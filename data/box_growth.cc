#include "data/box_growth.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "data/steepness_plan.h"

namespace sandwright {
namespace {

using Eigen::Vector2d;

constexpr double kCell_px = 1.5;
constexpr int kFirstHalf = 8;  // cells: a rectangle of a few centimetres

// A side in cells of the plan; index as in Rectangle::side.
using Sides = std::array<int, 4>;

double SideSteepness(const SteepnessPlan& plan, const Sides& sides, size_t side) {
  const bool is_x = side < 2;
  return plan.LineSteepness(is_x ? 0 : 1, sides[side], sides[is_x ? 2 : 0], sides[is_x ? 3 : 1]);
}

// Grows the rectangle around `seed`; empty where a side leaves the plan.
std::optional<Sides> Grow(const SteepnessPlan& plan, const Vector2d& seed, double wall_slope) {
  const int a = plan.Cell(seed, 0), b = plan.Cell(seed, 1);
  Sides sides = {a - kFirstHalf, a + kFirstHalf, b - kFirstHalf, b + kFirstHalf};
  if (std::ranges::min(sides) < 0 || std::ranges::max(sides) >= plan.cells()) return std::nullopt;
  for (bool moved = true; moved;) {
    moved = false;
    for (size_t side = 0; side < 4; ++side) {
      if (SideSteepness(plan, sides, side) > wall_slope) continue;
      sides[side] += side % 2 == 0 ? -1 : 1;
      if (sides[side] < 0 || sides[side] >= plan.cells()) return std::nullopt;
      moved = true;
    }
  }
  return sides;
}

// Mean steepness over the outline.
double OutlineSteepness(const SteepnessPlan& plan, const Sides& sides) {
  double sum = 0, length = 0;
  for (size_t side = 0; side < 4; ++side) {
    const int cells = side < 2 ? sides[3] - sides[2] : sides[1] - sides[0];
    sum += cells * SideSteepness(plan, sides, side);
    length += cells;
  }
  return sum / length;
}

// The middle of the picture and eight places around it: one of them sees the sand.
std::vector<Vector2d> Seeds(const LevelImage& image) {
  std::vector<Vector2d> seeds;
  const auto width = static_cast<double>(image.camera.width);
  const auto height = static_cast<double>(image.camera.height);
  for (int k = 0; k < 9; ++k) {
    const Eigen::Vector3f* p = image.At({width * (2 + k % 3) / 6, height * (2 + k / 3) / 6});
    if (p->allFinite()) seeds.push_back(p->head<2>().cast<double>());
  }
  return seeds;
}

// Median distance of what the camera sees, along the vertical.
double MedianDepth(const LevelImage& image) {
  std::vector<float> depths;
  for (const Eigen::Vector3f& p : image.points_L)
    if (p.allFinite()) depths.push_back(-p.z());
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::ranges::nth_element(depths, middle);
  return *middle;
}

}  // namespace

std::optional<Rectangle> GrowRectangle(const LevelImage& image, const AngleRange& angles,
                                       double wall_slope, double min_side_m) {
  const std::vector<Vector2d> seeds = Seeds(image);
  if (seeds.empty()) return std::nullopt;
  const std::vector<SteepPoint> points = SteepPoints(image);
  const double pixel_m = MedianDepth(image) / image.camera.fx_px;
  const double cell_m = kCell_px * pixel_m;
  const double reach_m =
      0.5 * pixel_m *
      std::hypot(static_cast<double>(image.camera.width), static_cast<double>(image.camera.height));
  Vector2d middle = Vector2d::Zero();
  for (const Vector2d& seed : seeds) middle += seed / static_cast<double>(seeds.size());

  std::optional<Rectangle> best;
  double steepest = -std::numeric_limits<double>::infinity();
  for (int degree = 0; degree < angles.degrees; ++degree) {
    const double angle = angles.first_rad + degree * std::numbers::pi / 180;
    const SteepnessPlan plan(points, middle, reach_m, angle, cell_m);
    for (const Vector2d& seed : seeds) {
      const auto sides = Grow(plan, seed, wall_slope);
      if (!sides) continue;
      const int smaller = std::min((*sides)[1] - (*sides)[0], (*sides)[3] - (*sides)[2]);
      const double steepness = OutlineSteepness(plan, *sides);
      if (smaller * cell_m < min_side_m || steepness <= steepest) continue;
      steepest = steepness;
      best = Rectangle{angle, {}};
      for (size_t side = 0; side < 4; ++side)
        best->side[side] = plan.Position((*sides)[side], side < 2 ? 0 : 1);
    }
  }
  return best;
}

}  // namespace sandwright
