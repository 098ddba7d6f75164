// Strokes along the optimal transport from surplus to deficit, without a sand model.
#pragma once

#include "agents/planner_tool.h"
#include "agents/wedge_stroke.h"
#include "data/base/config.h"

namespace sandwright {

struct SweepConfig {
  double bin_m = 0.025;
  WedgeConfig wedge = {};

  void Fields(FieldList& f) {
    f.Add("bin_m", bin_m, "side of the squares that sand is brought between [m]", 0.005, 0.2);
    f.Section("wedge", wedge);
  }
};

class SweepAgent final : public Agent {
 public:
  SweepAgent(const PlannerTool& tool, const SweepConfig& config) : tool_(tool), config_(config) {}

  std::string name() const override { return "sweep"; }
  // A stroke along the flow that, together with its neighbours under the blade, moves most. Refused
  // strokes: FirstAccepted, by the flows in order.
  std::vector<Action> Act(std::span<const TaskView> views,
                          std::span<RandomStream> streams) override;

 private:
  PlannerTool tool_;
  SweepConfig config_;
};

}  // namespace sandwright
