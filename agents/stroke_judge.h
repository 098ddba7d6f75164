// What planners think of strokes: the goal error afterwards by a sand model, and what the gate says.
// One judge for all planners that look ahead, so that they differ in their search alone.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "agents/planner_tool.h"
#include "env/sand_model.h"

namespace sandwright {

// Strokes one after another. An agent executes the first and looks again.
using StrokePlan = std::vector<Action>;

struct JudgedPlan {
  StrokePlan strokes;
  double error_m = 0;            // goal error after the last of them, by the model
  std::optional<bool> accepted;  // the first of them by the gate; none: not asked yet
};

class StrokeJudge {
 public:
  // `model` and `gate` must outlive it.
  StrokeJudge(const SandModel& model, double speed_mps, const SafetyGate* gate = nullptr)
      : model_(model), tool_{model.blade(), speed_mps, gate} {}

  // Judges plans of equal length, in order. Each stroke is decoded on the sand that the one before
  // left. The plans are applied in batches whose maps take no more than about 128 MB, whatever
  // their number; the result does not depend on it.
  std::vector<JudgedPlan> Judge(const TaskView& view, std::vector<StrokePlan> plans);

  // Leaves the `count` best, the best first: those whose first stroke the gate accepts before all
  // others. Asks the gate from the best on until it has accepted so many, so that few meet it.
  void KeepBest(const TaskView& view, size_t count, std::vector<JudgedPlan>& plans) const;

  // Applications of the model so far: a plan of H strokes is H.
  int64_t model_evaluations() const { return model_evaluations_; }

 private:
  // The sand after each plan.
  std::vector<SandState> Imagine(const TaskView& view, const SandState& start,
                                 std::span<const StrokePlan> plans);

  const SandModel& model_;
  PlannerTool tool_;
  int64_t model_evaluations_ = 0;
};

}  // namespace sandwright
