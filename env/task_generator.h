// Tasks without end: random terrains, random goals, difficulty in a stated range.
#pragma once

#include "data/base/config.h"
#include "data/base/random.h"
#include "data/task.h"
#include "env/drawn_goal.h"
#include "env/goals.h"
#include "env/terrain_generator.h"

namespace sandwright {

// What tasks are drawn for. Training and evaluation draw from different streams, so no
// training seed ever yields an evaluation task.
inline constexpr uint64_t kTrainingTasks = StreamId("training task");
inline constexpr uint64_t kEvaluationTasks = StreamId("evaluation task");
static_assert(kTrainingTasks != kEvaluationTasks);

struct TaskConfig {
  double width_m = 0.3, depth_m = 0.3;
  double cell_size_m = 0.01;
  double goal_width_m = 0, goal_depth_m = 0;
  double area_low = 1, area_high = 1;
  std::vector<std::string> goals = {"level", "mound", "crater", "trench", "ridge", "terrace"};
  double margin_m = 0, margin_share = 1;
  double narrowest_m = 0.03;
  double difficulty_low_m = 0.004, difficulty_high_m = 0.010;
  int64_t max_strokes = 10;
  // Hills a few blades wide: what strokes can shape within a budget.
  TerrainConfig terrain = {.amplitude_m = 0.012, .longest_m = 0.2, .scales = 2, .persistence = 0.4};

  void Fields(FieldList& f) {
    f.Add("width_m", width_m, "box along x [m]", 0.05, 5);
    f.Add("depth_m", depth_m, "box along y [m]", 0.05, 5);
    f.Add("cell_size_m", cell_size_m, "cells of the sand [m]", 0.001, 0.05);
    f.Add("goal_width_m", goal_width_m, "goal's place along x [m]; 0: the whole box", 0, 5);
    f.Add("goal_depth_m", goal_depth_m, "goal's place along y [m]; 0: the whole box", 0, 5);
    f.Add("area_low", area_low, "least share of the goal's place that counts", 0.01, 1);
    f.Add("area_high", area_high, "largest share of the goal's place that counts", 0.01, 1);
    f.Add("goals", goals, "kinds to draw from: level, mound, crater, trench, ridge, terrace, letters");
    f.Add("margin_m", margin_m,
          "how far around its shape a goal counts [m]; 0, and letters: all of its place", 0, 1);
    f.Add("margin_share", margin_share, "share of the shapes that margin_m is for; of the others all counts",
          0, 1);
    f.Add("narrowest_m", narrowest_m, "letters and drawings: nothing is narrower [m]", 0.005, 1);
    f.Add("difficulty_low_m", difficulty_low_m, "least goal error at the start [m]", 0.0001, 0.05);
    f.Add("difficulty_high_m", difficulty_high_m, "largest goal error at the start [m]", 0.0001,
          0.05);
    f.Add("max_strokes", max_strokes, "budget of a task [strokes]", 1, 10000);
    f.Section("terrain", terrain);
  }
};

// A random task: natural terrain and goal, both flattened about the mean sand depth by
// one factor that brings the goal error at the start into the difficulty range
// (uniform over what the draw allows of it); flattening keeps slopes within repose.
// Throws Error where no draw in 50 is rough enough.
Task GenerateTask(const TaskConfig& config, RandomStream& stream);

// A random terrain of the configured box and cells.
HeightMap DrawTerrain(const TaskConfig& config, RandomStream& stream);

// A random goal of the given kinds on a terrain that is given; the difficulty follows from the two.
Task GenerateGoal(const TaskConfig& config, const HeightMap& terrain, RandomStream& stream);

// A goal from a drawing (env/drawn_goal.h) at a random place of the configured extent.
Task GenerateDrawnGoal(const TaskConfig& config, const cv::Mat& grey, double range_m,
                       const HeightMap& terrain, RandomStream& stream);

}  // namespace sandwright
