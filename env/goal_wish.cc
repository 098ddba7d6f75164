#include "env/goal_wish.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace sandwright {
namespace {

constexpr double kTooLarge = 3;  // of the box
constexpr int kSamples = 4;

bool AsItIs(const HeightMap& shape, const WishPlace& place, const HeightMap& terrain) {
  return shape.SameGrid(terrain) && !place.at_m && place.scale == 1 && place.turn_rad == 0;
}

// The shape's height at a place of its own, NaN beside it. Near a hole the cell's own height.
double ShapeAt(const HeightMap& shape, double x_m, double y_m) {
  const double u = std::floor(x_m / shape.cell_size_m), v = std::floor(y_m / shape.cell_size_m);
  if (u < 0 || v < 0 || u >= shape.columns || v >= shape.rows) return std::nan("");
  const double own_m = shape.At(static_cast<int>(v), static_cast<int>(u));
  if (std::isnan(own_m)) return own_m;
  const double smooth_m = HeightAt(shape, x_m, y_m);
  return std::isnan(smooth_m) ? own_m : smooth_m;
}

class Placement {
 public:
  Placement(const HeightMap& shape, const WishPlace& place, const HeightMap& terrain)
      : shape_(shape), place_(place), cell_size_m_(terrain.cell_size_m),
        at_m_(place.at_m.value_or(Eigen::Vector2d(terrain.width_m() / 2, terrain.depth_m() / 2))) {}

  // Mean over a cell, NaN where less than half of it lies on the shape.
  double CellMean(int row, int column) const {
    double sum = 0;
    int on = 0;
    for (int j = 0; j < kSamples; ++j) {
      for (int i = 0; i < kSamples; ++i) {
        const Eigen::Vector2d part(column + (i + 0.5) / kSamples, row + (j + 0.5) / kSamples);
        const Eigen::Vector2d off = part * cell_size_m_ - at_m_;
        const double c = std::cos(place_.turn_rad), s = std::sin(place_.turn_rad);
        const double h = ShapeAt(shape_, (c * off.x() + s * off.y()) / place_.scale + shape_.width_m() / 2,
                                 (c * off.y() - s * off.x()) / place_.scale + shape_.depth_m() / 2);
        if (!std::isnan(h)) sum += h, ++on;
      }
    }
    return 2 * on >= kSamples * kSamples ? sum / on : std::nan("");
  }

 private:
  const HeightMap& shape_;
  const WishPlace& place_;
  double cell_size_m_;
  Eigen::Vector2d at_m_;
};

}  // namespace

void CheckWishExtent(double width_m, double depth_m, const HeightMap& terrain, const std::string& name) {
  if (std::max(width_m, depth_m) <= kTooLarge * std::max(terrain.width_m(), terrain.depth_m())) return;
  throw Error(fmt::format("{}: {:.4g} x {:.4g} m, and the box is {:g} x {:g} m; is the unit right (--unit mm is a "
                          "thousandth of --unit m)? --size W makes it W m wide",
                          name, width_m, depth_m, terrain.width_m(), terrain.depth_m()));
}

Wish PlaceWish(const HeightMap& shape, const WishPlace& place, const HeightMap& terrain, const std::string& name) {
  SAND_CHECK(place.scale > 0, place.scale);
  CheckWishExtent(place.scale * shape.width_m(), place.scale * shape.depth_m(), terrain, name);
  Wish wish{terrain, 0};
  HeightMap& goal = wish.goal;
  goal.valid.clear();
  goal.mask.assign(goal.size(), 0);
  const Placement placement(shape, place, terrain);
  const bool as_it_is = AsItIs(shape, place, terrain);
  for (int row = 0; row < goal.rows; ++row) {
    for (int column = 0; column < goal.columns; ++column) {
      const double h = as_it_is ? shape.At(row, column) : placement.CellMean(row, column);
      if (std::isnan(h)) continue;
      goal.At(row, column) = static_cast<float>(place.zero_m + place.height_scale * h);
      goal.mask[goal.Index(row, column)] = 1;
    }
  }
  const auto counted = std::ranges::count(goal.mask, 1);
  if (counted < 2)
    throw Error(fmt::format("{}: {:.4g} x {:.4g} m at its place cover {} cells of the sand ({:g} m each); at least 2 "
                            "are needed: is the unit right, and does it lie in the box of {:g} x {:g} m?",
                            name, place.scale * shape.width_m(), place.scale * shape.depth_m(), counted,
                            terrain.cell_size_m, terrain.width_m(), terrain.depth_m()));
  const double side_m = place.scale * shape.cell_size_m;
  const auto on_shape = std::ranges::count_if(shape.height_m, [](float h) { return !std::isnan(h); });
  const double shape_m2 = side_m * side_m * static_cast<double>(on_shape);
  const double placed_m2 = terrain.cell_size_m * terrain.cell_size_m * static_cast<double>(counted);
  wish.cut_share = std::max(0.0, 1 - placed_m2 / shape_m2);
  return wish;
}

double MeanCounted(const HeightMap& map) {
  double sum_m = 0;
  size_t count = 0;
  for (size_t i = 0; i < map.size(); ++i) {
    if (std::isnan(map.height_m[i]) || (!map.mask.empty() && !map.mask[i])) continue;
    sum_m += map.height_m[i];
    ++count;
  }
  SAND_CHECK(count > 0);
  return sum_m / static_cast<double>(count);
}

}  // namespace sandwright
