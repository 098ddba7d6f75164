// The excavation routine of Deep Sandscapes (Tsuruta et al. 2022): random strokes, one after
// another, from which a sand model is learned.
#pragma once

#include "data/base/random.h"
#include "data/height_map.h"
#include "data/stroke.h"

namespace sandwright {

struct ExcavationConfig {
  double cube_m = 0.255;
  double wall_margin_m = 0.035;
  double floor_margin_m = 0.01;
  double deepest_m = 0.03;
  double above_m = 0.004;
  double shortest_m = 0.04;
  double speed_mps = 0.1;

  void Fields(FieldList& f) {
    f.Add("cube_m", cube_m, "all control points of a stroke lie in a cube of this side [m]", 0.02,
          2);
    f.Add("wall_margin_m", wall_margin_m, "control points stay this far from the walls [m]", 0, 1);
    f.Add("floor_margin_m", floor_margin_m, "control points stay this far above the floor [m]", 0,
          1);
    f.Add("deepest_m", deepest_m, "deepest control point below the sand's surface [m]", 0.001, 0.5);
    f.Add("above_m", above_m, "highest control point above the sand's surface [m]", 0, 0.5);
    f.Add("shortest_m", shortest_m, "shortest path in the plane [m]", 0.002, 2);
    f.Add("speed_mps", speed_mps, "speed of the blade [m/s]", 0.001, 2);
  }
};

// A random stroke anywhere in the box of `terrain`: its class A..F is drawn uniformly, then 2-4
// points in a cube placed at random, depths relative to the sand's surface there. Draws that
// CheckStroke refuses are drawn again. Throws Error where the box leaves no room.
Stroke DrawStroke(const ExcavationConfig& config, const HeightMap& terrain, RandomStream& stream);

}  // namespace sandwright
