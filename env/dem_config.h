// Sand as grains: what they are and how a stroke is run through them.
#pragma once

#include <cstdint>
#include <string>

#include "data/base/config.h"
#include "data/stroke.h"

namespace sandwright {

// The defaults are coarse-grained dry sand that rests at about 33 degrees (docs/sand.md).
struct GrainMaterial {
  double grain_m = 0.006;
  double grain_spread = 0.2;
  double density_kgpm3 = 2650;
  double stiffness_pa = 1e5;
  double damping = 0.35;
  double friction = 0.5;
  double rolling_friction = 0.4;
  double time_step_share = 0.0376;

  void Fields(FieldList& f) {
    f.Add("grain_m", grain_m, "mean diameter of the grains [m]", 0.0005, 0.05);
    f.Add("grain_spread", grain_spread, "diameters are uniform within this share of the mean [1]", 0, 0.5);
    f.Add("density_kgpm3", density_kgpm3, "density of a grain [kg/m^3]", 100, 20000);
    f.Add("stiffness_pa", stiffness_pa, "contact stiffness over the mean diameter [N/m^2]", 1e3, 1e9);
    f.Add("damping", damping, "normal damping over its critical value [1]", 0, 1);
    f.Add("friction", friction, "between grains, and at walls and floor [1]", 0, 2);
    f.Add("rolling_friction", rolling_friction, "torque limit over normal force and radius [1]", 0, 2);
    f.Add("time_step_share", time_step_share, "time step over the duration of a contact [1]", 0.001, 0.1);
  }

  double mass_kg() const;  // of a mean grain
  // Of springs between mean grains: they sink into each other by the same share at any size.
  double stiffness_npm() const { return stiffness_pa * grain_m; }
  double time_step_s() const;
};

struct DemConfig {
  GrainMaterial material;
  double blade_friction = 0.4;
  double reach_m = 0.09;
  double speed_mps = 0.2;
  double plunge_mps = 0.25;
  double lift_mps = 0.6;
  double settle_s = 0.3;
  double blur_m = 0.002;
  int64_t ranks = 1;
  std::string cache;
  Blade blade;

  void Fields(FieldList& f) {
    f.Section("material", material);
    f.Add("blade_friction", blade_friction, "between grains and blade [1]", 0, 2);
    f.Add("reach_m", reach_m, "grains further than this from the path stay where they are [m]", 0.02, 10);
    f.Add("speed_mps", speed_mps, "speed of the blade along its path [m/s]", 0.01, 2);
    f.Add("plunge_mps", plunge_mps, "speed of the blade coming down [m/s]", 0.01, 2);
    f.Add("lift_mps", lift_mps, "speed of the blade going up [m/s]", 0.01, 2);
    f.Add("settle_s", settle_s, "time to come to rest, at most [s]", 0.01, 10);
    f.Add("blur_m", blur_m, "standard deviation of the blur of the surface seen [m]", 0, 0.1);
    f.Add("ranks", ranks, "MPI ranks of one run; 1: none needed", 1, 1024);
    f.Add("cache", cache, "folder for settled beds; empty: the user's cache folder");
    f.Section("blade", blade);
  }
};

}  // namespace sandwright
