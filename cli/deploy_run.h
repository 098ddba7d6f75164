// What `deploy` is asked for, and how it comes about.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "agents/deployment.h"
#include "agents/planner_configs.h"
#include "data/excavation.h"
#include "env/episode.h"
#include "env/sand_model_by_name.h"
#include "env/simulated_rig.h"

namespace sandwright {

struct DeployRequest {
  std::string arm = "simulated";  // or the controller's address
  bool armed = false;             // for another address than loopback
  std::string plan, terrain;      // a sealed plan and the scan that it was sealed for; or
  std::string agent, goal;        // an agent and what it is to reach; with neither: random strokes
  std::string model = "heightfield", world = "heightfield", workcell;
  std::string mode = "step", confirm = "keyboard";
  std::string verdict;            // of `plan --verdict`, that the end is compared with
  std::string log;
  bool resume = false;
  int max_strokes = 20;
  uint64_t seed = 0;
  int threads = 1;

  nlohmann::json ToJson() const;
};

// Of a real arm's controller; others than the standard ones for a stand-in.
struct ControllerPortSettings {
  int64_t dashboard_port = 29999, primary_port = 30001, rtde_port = 30004;

  void Fields(FieldList& f) {
    f.Add("dashboard_port", dashboard_port, "of the controller's dashboard server", 1, 65535);
    f.Add("primary_port", primary_port, "of its primary interface", 1, 65535);
    f.Add("rtde_port", rtde_port, "of its real-time data exchange", 1, 65535);
  }
};

struct DeploySettings {
  DeploymentConfig deployment;
  ControllerPortSettings controller;
  SimulatedRigConfig rig;
  SandModelConfig sand;
  PlannerConfigs planners;
  EpisodeConfig episode;
  ExcavationConfig excavation;  // of random strokes

  void Fields(FieldList& f) {
    f.Section("deployment", deployment);
    f.Section("controller", controller);
    f.Section("rig", rig);
    sand.Fields(f);
    planners.Fields(f);
    f.Section("episode", episode);
    f.Section("excavation", excavation);
  }
};

// The request of the log that is to be continued.
DeployRequest ReadDeployRequest(const std::string& log);

// Runs it, log and all. Throws Error: bad input, or kRefused where the plan may not run.
// `status` (none: nobody watches) is told how it goes.
Deployment RunDeploy(const DeployRequest& request, const DeploySettings& settings,
                     RunStatus* status = nullptr);

// A look at a plan without an arm: the gate's verdict and a picture of the strokes on the terrain in
// `picture` (where given).
nlohmann::json Preview(const DeployRequest& request, const std::string& picture);

// Tells what a log holds, line by line, on standard output; its summary.
nlohmann::json ReplayLog(const std::string& log);

nlohmann::json ToJson(const Deployment& deployment);

}  // namespace sandwright
