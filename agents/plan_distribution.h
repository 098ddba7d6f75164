// Independent normal distributions over the numbers of a plan, the heading on the circle.
#pragma once

#include <span>
#include <vector>

#include "agents/stroke_judge.h"

namespace sandwright {

struct PlanDistribution {
  // [strokes x kActionSize], on the action's [-1, 1]; a heading's mean lies in [-1, 1] and its sd is of
  // the way round from there.
  std::vector<double> mean, sd;

  // What `plans` (at least one, of equal length) have in common. A heading's mean is the direction of
  // the mean of the unit vectors, so that headings on both sides of pi do not average to zero.
  static PlanDistribution Fit(std::span<const JudgedPlan> plans);
  // Goes from here to `target` but for the share `kept` of the way, a heading the shorter way round.
  void Approach(const PlanDistribution& target, double kept);
  // No sd below `least_sd`; numbers beyond the bounds as WithinBounds.
  StrokePlan Draw(double least_sd, RandomStream& stream) const;
};

}  // namespace sandwright
