// What sand, blade and arm can make of a goal, and the nearest goal that they can.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "data/base/config.h"
#include "data/height_map.h"
#include "robot_model/reach_map.h"

namespace sandwright {

struct FeasibilityConfig {
  double repose_deg = 33;
  double narrowest_pit_m = 0.05;
  double narrowest_crest_m = 0.02;
  double free_spread_m = 0.02;

  void Fields(FieldList& f) {
    f.Add("repose_deg", repose_deg, "angle of repose: no slope stays steeper [deg]", 5, 60);
    f.Add("narrowest_pit_m", narrowest_pit_m,
          "pits and grooves are no narrower: the blade's width [m]; 0: as narrow as drawn", 0, 1);
    f.Add("narrowest_crest_m", narrowest_crest_m,
          "crests and heaps are no narrower [m]; 0: as narrow as drawn", 0, 1);
    f.Add("free_spread_m", free_spread_m,
          "how far the ground that does not count may rise or sink in the mean, to take or give sand; "
          "0: what counts keeps its volume [m]", 0, 1);
  }
};

// Over the cells that count.
struct Feasibility {
  double volume_missing_m3 = 0;  // the goal's above the terrain's; negative: sand is left over
  double steep_share = 0;        // of the cells: a slope beyond repose (by more than 2 %) at one of their sides
  double steepest_deg = 0;
  double narrow_share = 0;       // of the cells: in something narrower than allowed, by more than 1 mm
  double narrow_worst_m = 0;     // height that goes with it
  double below_floor_share = 0;  // of the cells; datum floor only
  std::optional<double> out_of_reach_share = {};  // of the cells: the arm can start no stroke there
};

// Why a cell of a goal cannot be made; bits of one number.
enum GoalFault : uint8_t { kOutOfReach = 1, kTooSteep = 2, kTooNarrow = 4, kBelowFloor = 8 };
// [cells] the faults of each cell by the same rules; 0 where it does not count.
std::vector<uint8_t> GoalFaults(const HeightMap& goal, const FeasibilityConfig& config, const ReachMap* reach);

// `goal` has its mask filled and the terrain's grid. `reach`: of the gate, or none.
Feasibility JudgeGoal(const HeightMap& goal, const HeightMap& terrain, const FeasibilityConfig& config,
                      const ReachMap* reach);

// The goal with pits and crests that are too narrow closed and cut, slopes beyond repose slid to rest as sand slides
// (volume kept; sand that does not count is taken for a smooth continuation), and all of it raised or lowered as far
// as the ground that does not count cannot take or give the difference in volume; nothing below the floor. Mask and everything else as in `goal`.
HeightMap NearestFeasible(const HeightMap& goal, const HeightMap& terrain, const FeasibilityConfig& config);

// Keys of `goal`, volumes in cm3, lengths in mm.
nlohmann::json ToJson(const Feasibility& feasibility);

}  // namespace sandwright
