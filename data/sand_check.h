// Is it sand? Sand has slopes that it can stand at, and no hard things on it.
#pragma once

#include <string>
#include <vector>

#include "data/base/config.h"
#include "data/height_map.h"

namespace sandwright {

struct SandCheckConfig {
  double max_relief_m = 0.40;
  double steep_deg = 65;  // damp sand, sieved and smoothed by a camera, still stands at 58
  double max_steep_share = 0.01;
  double object_edge_deg = 45;
  double object_top_deg = 30;
  double max_object_m2 = 0.0005;

  void Fields(FieldList& f) {
    f.Add("max_relief_m", max_relief_m, "highest less lowest point of sand [m]", 0.01, 5);
    f.Add("steep_deg", steep_deg, "slope that no sand has [deg]", 40, 89);
    f.Add("max_steep_share", max_steep_share, "share of the cells that may be steeper [-]", 0, 1);
    f.Add("object_edge_deg", object_edge_deg, "slope around a hard object, all the way round [deg]",
          35, 89);
    f.Add("object_top_deg", object_top_deg, "median slope inside of such a ring [deg]", 1, 45);
    f.Add("max_object_m2", max_object_m2, "area inside of such a ring that is let pass [m^2]", 0,
          10);
  }
};

// One text a reason why `map` is not, or not only, sand, with the
// figure and the limit; empty: sand.
//
// An object is an area that steep cells enclose all round although it is no steeper than sand
// itself: a plate, a tool, a box. Craters and heaps of sand have steep flanks too, but their tops
// and bottoms run into them without such an edge all round.
std::vector<std::string> ReasonsNotSand(const HeightMap& map, const SandCheckConfig& config);

}  // namespace sandwright
