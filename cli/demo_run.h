// What the demo does: scan, goal, verdict, agents in closed loop on a simulated rig, script.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "agents/planner_configs.h"
#include "agents/verdict.h"
#include "cli/demo_report.h"
#include "data/scan.h"
#include "env/heightfield.h"
#include "env/simulated_rig.h"

namespace sandwright {

struct DemoConfig {
  int64_t max_strokes = 12;
  std::string agent = "default";
  std::string model = "default";
  std::string goal = "crater";
  double sand_depth_m = 0.05;
  double region_m = 0.3;
  double speed_mps = 0.1;
  CameraModel camera;
  ScanConfig scan;
  HeightfieldConfig world;  // differs from the model on purpose: real sand is never the model
  SimulatedRigConfig rig;
  VerdictConfig verdict;
  PlannerConfigs planners;

  DemoConfig() {
    scan.cell_size_m = 0.004;
    world.repose_deg = 31;
  }
  void Fields(FieldList& f) {
    f.Add("max_strokes", max_strokes, "budget of each agent", 1, 1000);
    f.Add("agent", agent, "agent whose strokes are shown and exported");
    f.Add("model", model, "sand model that predicts and that greedy plans with");
    f.Add("goal", goal, "kind of goal", {"level", "mound", "crater", "trench", "ridge", "terrace"});
    f.Add("sand_depth_m", sand_depth_m, "mean depth of the sand: sets the zero of the heights [m]",
          0.02, 0.5);
    f.Add("region_m", region_m, "side of the square in the middle of the box that is shaped [m]",
          0.2, 0.6);
    f.Add("speed_mps", speed_mps, "speed of the blade [m/s]", 0.01, 0.25);
    f.Section("camera", camera);
    f.Section("scan", scan);
    f.Section("world", world);
    f.Section("rig", rig);
    f.Section("verdict", verdict);
    planners.Fields(f);
  }
};

// Throws Error (kRefused) where the frame is not sand in a box. After Ctrl-C: what was done so far.
DemoReport RunDemo(const std::string& frame_file, DemoConfig config, uint64_t seed, int threads);

// The keys of demo.json.
nlohmann::json DemoJson(const DemoReport& report);

}  // namespace sandwright
