// A shaping task: a terrain, a goal with a mask, a budget of strokes.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "data/height_map.h"

namespace sandwright {

struct Task {
  HeightMap terrain;
  HeightMap goal;  // same grid; `mask` (1 = counts) always filled; NaN only where mask is 0
  int max_strokes = 20;
};

// Throws Error where grids or datums differ, the mask counts nothing or a NaN, the goal reaches below
// the floor or holds no sand, or the budget is not positive.
void CheckTask(const Task& task, const std::string& source);

// A goal from a height map file: NaN and mask 0 mean "not counted"; the mask is filled.
HeightMap ReadGoal(const std::filesystem::path& file);

// Task files, schema "sandwright-tasks" version 1, with a `datum` beside each task's `max_strokes` and
// the attribute `content_sha256`; `benchmark` (env/benchmark_tasks.h) becomes an attribute where given.
std::vector<Task> ReadTasks(const std::filesystem::path& file);
void WriteTasks(const std::vector<Task>& tasks, const std::filesystem::path& file,
                const std::string& benchmark = "");

// SHA-256 of grids, heights, masks and budgets: the same for the same tasks in whatever file.
std::string TasksSha256(const std::vector<Task>& tasks);

// Mean |height - goal| over the goal's mask [m]: the goal error of every metric and reward.
double GoalError(const HeightMap& heights, const HeightMap& goal);

}  // namespace sandwright
