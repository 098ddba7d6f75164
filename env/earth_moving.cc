#include "env/earth_moving.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "data/base/error.h"

namespace sandwright {

double Draft_n(const EarthMoving& sand) {
  constexpr double kDegree = std::numbers::pi / 180;
  SAND_CHECK(sand.width_m > 0 && sand.depth_m > 0, sand.width_m, sand.depth_m);
  const double friction_rad = sand.repose_deg * kDegree, blade_rad = std::atan(sand.blade_friction);
  double least_n = std::numeric_limits<double>::infinity();
  for (double wedge_deg = 2; wedge_deg < 90; wedge_deg += 0.05) {
    const double wedge_rad = wedge_deg * kDegree;
    const double yield =
        -std::sin(blade_rad) + std::cos(blade_rad) / std::tan(wedge_rad + friction_rad);
    if (yield <= 0) break;
    const double rupture_m = sand.depth_m / std::tan(wedge_rad);
    const double sides = 1 + 2 * rupture_m / (3 * sand.width_m);
    const double weight_n =
        sand.unit_weight_npm3 * sand.width_m * sand.depth_m * rupture_m / 2 * sides;
    least_n = std::min(least_n, (weight_n + sand.surcharge_n) / yield);
  }
  return least_n * std::cos(blade_rad);
}

}  // namespace sandwright
