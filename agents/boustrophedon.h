// The lawn mower: straight passes in lanes beside each other, without a sand model.
#pragma once

#include "agents/planner_tool.h"
#include "agents/wedge_stroke.h"
#include "data/base/config.h"

namespace sandwright {

struct BoustrophedonConfig {
  double lane_spacing = 1;
  int64_t headings = 16;
  WedgeConfig wedge = {.start_back_m = -0.02,
                       .end_back_m = 0.03,
                       .depth_gain = 1.1,
                       .most_depth_m = 0.02,
                       .end_depth_m = -0.005};

  void Fields(FieldList& f) {
    f.Add("lane_spacing", lane_spacing, "from lane to lane, in widths of the blade", 0.1, 4);
    f.Add("headings", headings, "directions of lanes, the first along x, evenly around", 1, 64);
    f.Section("wedge", wedge);
  }
};

class BoustrophedonAgent final : public Agent {
 public:
  BoustrophedonAgent(const PlannerTool& tool, const BoustrophedonConfig& config)
      : tool_(tool), config_(config) {}

  std::string name() const override { return "boustrophedon"; }
  // Of all lanes in all directions the pass that fills most with sand from behind. Refused
  // strokes: FirstAccepted, by the passes in order, one for each place where sand lies too high.
  std::vector<Action> Act(std::span<const TaskView> views,
                          std::span<RandomStream> streams) override;

 private:
  PlannerTool tool_;
  BoustrophedonConfig config_;
};

}  // namespace sandwright
