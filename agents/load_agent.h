// Agents by name or file.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "agents/planner_configs.h"
#include "env/agent.h"

namespace sandwright {

// What `--agent` takes.
inline constexpr const char* kAgentNames =
    "random, boustrophedon, sweep, greedy, cem, ga, ranked, a shipped policy (default; walled: behind the gate of a 300 mm "
    "bed; sampler: that ranked draws from) or a .safetensors file of one";

// What an agent may need; `model` must outlive the agent.
struct AgentOptions {
  const SandModel& model;  // that planners plan with
  PlannerConfigs planners = {};
  double speed_mps = 0.1;            // of the strokes that planners imagine
  std::string device = "auto";       // of a policy's network
  const SafetyGate* gate = nullptr;  // whose refusals planners avoid; must outlive the agent
};

// One of kAgentNames. Throws Error that lists them for any other name,
// and for planners' keys that do not go together.
std::unique_ptr<Agent> LoadAgent(const std::string& name_or_file, const AgentOptions& options);

// The policy file that an agent reads; none: it reads none.
std::optional<std::filesystem::path> PolicyFileOf(const std::string& name_or_file, const PlannerConfigs& planners);

}  // namespace sandwright
