#include "agents/planner_tool.h"

#include <algorithm>

#include "agents/stroke_proposal.h"
#include "robot_model/safety_gate.h"

namespace sandwright {

bool PlannerTool::Accepts(const TaskView& view, const Action& action) const {
  return !gate || gate->Check(Decode(action, view.sensed, view.region), view.sensed,
                              GateSampling::kCoarse)
                      .accepted;
}

Action FirstAccepted(const PlannerTool& tool, const TaskView& view,
                     std::span<const Action> best_first, RandomStream& stream) {
  const auto refused = static_cast<size_t>(view.rejected_in_a_row);
  const auto left = best_first.subspan(std::min(refused, best_first.size()));
  const auto found =
      std::ranges::find_if(left, [&](const Action& action) { return tool.Accepts(view, action); });
  return found == left.end() ? RandomAction(stream) : *found;
}

}  // namespace sandwright
