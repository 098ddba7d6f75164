// The tool that planners imagine their strokes with, and the gate that may refuse them.
#pragma once

#include <span>

#include "data/base/random.h"
#include "env/agent.h"

namespace sandwright {

struct PlannerTool {
  Blade blade;
  double speed_mps = 0.1;
  const SafetyGate* gate = nullptr;  // none: every stroke is accepted; must outlive its user

  Stroke Decode(const Action& action, const HeightMap& sensed, const Region& region) const {
    return DecodeAction(action, sensed, region, blade, speed_mps);
  }
  // By the gate's coarse sampling on the sensed map.
  bool Accepts(const TaskView& view, const Action& action) const;
};

// For planners without chance: the first of `best_first` that the gate accepts. A stroke that was
// refused left the sand as it was, so that the same list comes again: as many of its first strokes
// as were refused in a row are passed over. Where nothing is left, a random stroke.
Action FirstAccepted(const PlannerTool& tool, const TaskView& view,
                     std::span<const Action> best_first, RandomStream& stream);

}  // namespace sandwright
