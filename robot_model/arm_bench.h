// What the arm's part costs on this machine, and what the shipped cell reaches.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "robot_model/safety_gate.h"

namespace sandwright {

struct ArmBench {
  int64_t strokes = 2000;  // random ones, of the excavation routine
  uint64_t seed = 1;
  int threads = 1;
};

// Rows {name, ms_per_stroke or us_per_pose, ...} as they are measured: inverse kinematics of all
// branches and its worst error, the gate's two samplings, a plan with its transfers, random strokes
// that each sampling accepts and how far the joint motion strays from their paths. Times: best of
// five rounds, since the machine does other things too.
void RunArmBench(const SafetyGate& gate, const ArmBench& bench,
                 const std::function<void(const nlohmann::json&)>& report);

// Share of 16 headings of a 120 mm stroke around each 20 mm cell of level sand that the gate accepts.
struct ReachPicture {
  double share_of_box = 0;
  double share_inside_walls = 0;  // of those that the walls leave room for
  cv::Mat picture;                // BGR, the arm's base below the box
};
ReachPicture DrawReach(const SafetyGate& gate, int threads);

}  // namespace sandwright
