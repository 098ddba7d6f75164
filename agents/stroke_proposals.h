// Strokes worth trying, drawn without a sand model.
#pragma once

#include <vector>

#include "env/agent.h"

namespace sandwright {

// Random strokes, most of them starting where sand lies above the goal, the more the likelier.
class SurplusProposals {
 public:
  // `surplus_share`: of the strokes that start so. `view` must outlive it.
  explicit SurplusProposals(const TaskView& view, double surplus_share = 0.8);
  Action Draw(RandomStream& stream) const;

 private:
  const HeightMap& map_;
  Region region_;
  double surplus_share_;
  std::vector<double> cumulative_;  // surplus at each counted cell, summed up in row-major order
};

// A stroke drawn around `best`: normal, sd 0.15 in each number. The heading wraps around; the other
// numbers stop at their bounds.
Action Near(const Action& best, RandomStream& stream);

}  // namespace sandwright
