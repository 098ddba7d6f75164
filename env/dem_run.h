// One run of LAMMPS (https://www.lammps.org, package GRANULAR) over grains near a place.
//
// LAMMPS runs as a program of its own: an error inside it then ends that run and not this program
// (the library that Debian ships exits where it finds one), and it may use several MPI ranks.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "env/dem_config.h"
#include "env/grains.h"

namespace sandwright {

// A straight piece of the blade's motion.
struct BladeMove {
  BladePose from, to;
  double seconds;
};

// All grains at one moment. Springs: those between grains, normal to the contact.
struct DemSample {
  double time_s;
  double kinetic_j;        // of translation and spin
  double height_j;         // of gravity, above the floor
  double spring_j;
  double deepest_overlap;  // as in DemReport [1]
};

// Force of the grains on the blade in frame B, a mean over the 20 ms up to `time_s`.
struct BladeLoad {
  double time_s;
  Eigen::Vector3d force_n;
};

// What a run found, beside where the grains came to rest.
struct DemReport {
  int64_t grains_moving = 0, grains_lost = 0;
  double simulated_s = 0, wall_s = 0;
  double deepest_overlap = 0;          // largest contact force over stiffness and mean diameter [1]
  double fastest_mps = 0;              // of any grain at any sample
  double rest_speed_mps = 0;           // rms over the grains at the end
  std::vector<DemSample> samples;      // every 20 ms from the start of the motion on
  std::vector<BladeLoad> blade_loads;  // while there is a blade; time 0 is its first move
};

// A smooth wall that holds grains while their contacts load, and is gone when the motion starts: at
// x_m, holding what lies below; with a radius, a cylinder around (x_m, y_m), holding what lies inside.
struct DemGate {
  double x_m, y_m = 0, radius_m = 0;
};

// Grains that move and grains that hold them, in a box from `low` to `high` [m, along x and y]. Grains
// that pass a side without a wall by 10 mm are lost.
struct DemScene {
  double low_m[2], high_m[2];
  bool wall_low[2], wall_high[2];  // this side is a wall; elsewhere held grains stand
  std::vector<Grain> grains;
  std::vector<uint8_t> held;                  // [grains] 1 = does not move
  std::vector<Eigen::Vector3d> velocity_mps;  // [grains] at the start; empty: at rest
  std::optional<double> wall_friction = {};   // of the sides; none: as between grains
  std::optional<DemGate> gate = {};
};

// Fills a box: grains on a loose lattice fall and come to rest, first without rolling friction (which
// packs them as densely as sheared sand, so that strokes swell it little).
DemReport SettleGrains(const DemConfig& config, DemScene& scene, const std::function<bool()>& stop);

// Runs the blade through `moves` (none: grains come to rest under gravity alone), then waits until
// they rest. Throws Error: LAMMPS is missing (with how to get it), stopped, or failed (its message).
DemReport RunGrains(const DemConfig& config, std::span<const BladeMove> moves, DemScene& scene,
                    const std::function<bool()>& stop);

}  // namespace sandwright
