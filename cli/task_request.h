// Tasks from what a user gives and what is left to chance.
#pragma once

#include <string>
#include <vector>

#include "env/task_generator.h"
#include "env/varied_goal.h"

namespace sandwright {

struct TaskRequest {
  std::vector<std::string> terrain_files;  // or `generate`
  bool generate = false;                   // random terrains
  // The goal of each is one of these three; with `generate` and no drawing it is random.
  std::string goal_file;
  bool random_goals = false;
  cv::Mat drawing;                         // see MakeDrawnGoal
  double range_m = 0;                      // of the drawing
  bool vary = false;                       // `goal_file` only: each task has its own variation of it
  VaryConfig variation = {};
  int count = 0;                           // 0: one a terrain; 10 with `generate`
};

// Task i draws from evaluation stream i. Throws Error where something is missing or does not fit.
std::vector<Task> MakeTasks(const TaskRequest& request, const TaskConfig& config, uint64_t seed,
                            int threads);

}  // namespace sandwright
