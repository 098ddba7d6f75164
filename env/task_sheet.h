// Tasks as one picture to look at.
#pragma once

#include <opencv2/core.hpp>
#include <span>

#include "data/task.h"

namespace sandwright {

// Terrain and goal of each task side by side on one height scale (the goal pale where it does not count),
// under its number, the goal error at the start and the budget; four tasks a row.
cv::Mat DrawTasks(std::span<const Task> tasks);

}  // namespace sandwright
