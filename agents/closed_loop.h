// An agent at work on one bed, stroke by stroke: look, choose, gate, predict, execute, look again.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "env/agent.h"
#include "env/episode.h"
#include "env/sand_model.h"
#include "robot_model/safety_gate.h"

namespace sandwright {

// What is to be done. The goal has the terrain's grid.
struct ShapingJob {
  HeightMap terrain;  // as sensed, datum floor
  HeightMap goal;     // with mask
  Region region;
  int max_strokes = 20;
  double speed_mps = 0.1;
  double success_error_m = 0.002;
  int max_rejected_in_a_row = 3;
};

// One stroke of a run. A rejected stroke has reasons and moves nothing.
struct ShapingStroke {
  Stroke stroke;
  GateVerdict verdict;      // fine sampling, on `before`
  HeightMap before;         // sensed
  HeightMap predicted;      // by the model, from `before`
  HeightMap after;          // sensed after the execution; without a rig the prediction
  double goal_error_m = 0;  // of `after`
  double choose_ms = 0, gate_ms = 0, predict_ms = 0;
};

struct ShapingRun {
  double start_error_m = 0;
  std::vector<ShapingStroke> strokes = {};  // rejected ones too, in order
  bool stopped = false;                     // by Ctrl-C, before it had to end
  int rejected() const;
  double final_error_m() const {
    return strokes.empty() ? start_error_m : strokes.back().goal_error_m;
  }
};

// Executes one stroke that passed the gate and returns the bed as sensed afterwards, on the
// terrain's grid.
using Execute = std::function<HeightMap(const Stroke&)>;

// The agent's next stroke for the bed as sensed, after so many strokes of the job's budget.
Stroke ChooseStroke(Agent& agent, const ShapingJob& job, const HeightMap& sensed, int strokes_used,
                    int rejected_in_a_row, const SafetyGate& gate, const Blade& blade,
                    RandomStream& stream);

// Runs until the goal error is at most success_error_m, the strokes are used up, or too many in a
// row are rejected. Without `execute` the model's prediction is taken for the result: that is
// planning. After Ctrl-C no further stroke is chosen. Error where the goal's grid is another or the
// terrain's datum is relative.
ShapingRun RunClosedLoop(Agent& agent, const SandModel& model, const SafetyGate& gate,
                         const ShapingJob& job, RandomStream stream,
                         const Execute& execute = nullptr);

}  // namespace sandwright
