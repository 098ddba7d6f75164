// What a policy sees of a task: the region around the goal as a small stack of maps, and a few
// numbers.
#pragma once

#include "data/base/config.h"
#include "env/agent.h"
#include "env/vec_env.h"

namespace sandwright {

struct ObservationConfig {
  int64_t rows = 32, columns = 32;  // cells over the region's depth and width
  double blur_m = 0.03;
  bool reach = false;

  void Fields(FieldList& f) {
    f.Add("rows", rows, "observation cells over the region's depth (y)", 4, 256);
    f.Add("columns", columns, "observation cells over the region's width (x)", 4, 256);
    f.Add("blur_m", blur_m, "sd of the Gaussian that blurs the coarse goal difference [m]", 0.001,
          0.5);
    f.Add("reach", reach, "a channel more: where the arm can start a stroke");
  }
};

// Lengths that become 1 in an observation: fixed, so that a number means the same in every task.
inline constexpr double kHeightScale_m = 0.05;      // heights against the region's mean
inline constexpr double kDifferenceScale_m = 0.02;  // goal minus height
inline constexpr double kErrorScale_m = 0.01;       // goal error
inline constexpr double kBudgetScale = 20;          // strokes

// map [5 or 6, rows, columns], row 0 at the region's smallest y:
//   height            sensed height less its mean over the region, / 0.05 m; 0 outside the walls
//   goal_difference   goal minus sensed height, / 0.02 m; 0 where the goal does not count
//   goal_difference_coarse  the same, blurred
//   mask              share of the cell where the goal counts
//   in_box            share of the cell inside the walls
//   reach             share of the headings in which the arm can start a stroke in the middle of the cell
//                     (robot_model/reach_map.h); without an arm 1 inside the walls, else 0
// vec [4]:
//   budget_left       strokes left / 20
//   budget_used       strokes used / budget
//   rejected          strokes rejected in a row / 3
//   goal_error        sensed goal error / 0.01 m
ObservationSpec SpecOf(const ObservationConfig& config);

// The channel `reach` at a point of frame B.
float ReachAt(const TaskView& view, double x_m, double y_m);

// Writes one observation: `map_chw` SpecOf().map_size() and `vec` SpecOf().vec_size() numbers. The
// region is resampled area-weighted where its cells are coarser than
// the map's, bilinear where finer.
void Encode(const TaskView& view, const ObservationConfig& config, float* map_chw, float* vec);

}  // namespace sandwright
