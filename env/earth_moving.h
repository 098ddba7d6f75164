// The fundamental equation of earth moving: what a blade needs to shear sand.
#pragma once

namespace sandwright {

// Dry sand in front of a vertical blade.
struct EarthMoving {
  double width_m, depth_m;  // of the blade; below the level surface
  double unit_weight_npm3;  // of sand with its pores
  double repose_deg;        // angle of internal friction
  double blade_friction;    // tangent of the angle at the blade
  double surcharge_n = 0;   // weight of the sand heaped on the wedge
};

// Horizontal force on the blade [N]: the sand fails along the wedge that resists least, with side
// wedges (McKyes and Ali, Journal of Terramechanics 14, 1977). A blade of infinite width gives the
// plane wedge (Reece 1964), which without friction at the blade is Rankine's passive pressure.
double Draft_n(const EarthMoving& sand);

}  // namespace sandwright
