// The demo's page: one self-contained report.html that tells a run from frame to script.
#pragma once

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "agents/closed_loop.h"
#include "robot_model/plan.h"

namespace sandwright {

// One agent's run on the demo's bed.
struct DemoRun {
  std::string agent;
  ShapingRun run = {};
  double seconds = 0;  // wall time of the whole run, rescans and all
};

struct DemoReport {
  std::string frame_name;    // what was scanned, for people
  cv::Mat frame;             // the depth frame as a grey picture
  std::string scan_summary;  // one sentence with figures
  HeightMap terrain, goal;   // whole box, as scanned
  Region region;
  Workcell cell;
  std::string model, world;   // what predicts and what executes, one sentence each
  std::vector<DemoRun> runs;  // the policy first, then its rivals
  nlohmann::json verdict, outcome;  // before the policy's run, and how it came out; null: stopped before
  cv::Mat verdict_picture;
  double success_error_mm = 2;
  std::optional<cv::Mat> arm;                     // rendered over the box
  std::string arm_note;                           // shown where there is no picture
  std::vector<double> time_s;                     // of the executed motion, a NaN after each stroke
  std::vector<std::array<double, 6>> joints_rad;  // at those times
  double tracking_error_mm = 0;                   // largest distance of blade from plan
  Plan plan;                  // the accepted strokes; sealed where they are safe as one program
  std::string urscript;       // of the plan; "" where it is not sealed
  std::string urscript_note;  // what there is to say about it
  bool stopped = false;       // by Ctrl-C: the runs are those so far
  std::vector<std::pair<std::string, double>> timings_s;
};

std::string RenderDemoReport(const DemoReport& report);

}  // namespace sandwright
