// One task by several agents, beside each other.
#pragma once

#include <opencv2/core.hpp>
#include <span>
#include <string>

#include "data/task.h"

namespace sandwright {

struct AgentEnd {
  std::string agent;
  HeightMap end;  // the sand after its last stroke
};

// From left to right start, goal and each agent's end, captioned with the goal error; above the heights under one
// scale, below the difference to the goal (+-12 mm, grey where it does not count). BGR.
cv::Mat DrawAgentStrip(const Task& task, std::span<const AgentEnd> ends);

}  // namespace sandwright
