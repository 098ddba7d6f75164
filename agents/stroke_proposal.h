// Strokes worth trying before anything is known about them.
#pragma once

#include <vector>

#include "data/base/random.h"
#include "env/agent.h"

namespace sandwright {

// Uniform over all actions.
Action RandomAction(RandomStream& stream);

// Random actions on one view, most of which start where there is sand to take away.
class StrokeProposal {
 public:
  // `surplus_share` of the actions start where sand lies above the goal, the more the likelier. Keeps
  // no reference to `view`.
  StrokeProposal(const TaskView& view, double surplus_share);

  Action Draw(RandomStream& stream) const;
  // `count` of them one after another, each by the surplus that there is now.
  std::vector<Action> Draw(size_t count, RandomStream& stream) const;

 private:
  double surplus_share_;
  Region region_;
  int columns_;
  double cell_m_;
  std::vector<double> cumulative_surplus_m_;  // [rows x columns], summed up in row-major order
};

}  // namespace sandwright
