// Who chooses the strokes: learned policies, planners and rivals alike.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/base/random.h"
#include "env/action.h"

namespace sandwright {

class SafetyGate;

// All that an agent may know: sensed heights, never the world's true state.
struct TaskView {
  const HeightMap& sensed;
  const HeightMap& goal;  // with mask
  Region region;
  int strokes_used = 0, max_strokes = 0;
  int rejected_in_a_row = 0;  // strokes that the gate refused since the last accepted one
  const SafetyGate* gate = nullptr;  // of the arm, where there is one
};

class Agent {
 public:
  virtual ~Agent() = default;
  virtual std::string name() const = 0;
  // One action a view; `streams[i]` is the randomness of view i and advances.
  virtual std::vector<Action> Act(std::span<const TaskView> views,
                                  std::span<RandomStream> streams) = 0;
  // Extent along x and y of the regions that the agent was made for [m]; none: any.
  virtual std::optional<std::array<double, 2>> region_size_m() const { return std::nullopt; }
  // Evaluations of a sand model so far (0: the agent plans with none).
  virtual int64_t model_evaluations() const { return 0; }
};

}  // namespace sandwright
