// Agents by name or file.
#pragma once

#include <memory>
#include <string>

#include "agents/greedy.h"
#include "env/agent.h"

namespace sandwright {

// What an agent may need; `model` must outlive the agent.
struct AgentOptions {
  const SandModel& model;  // that planners plan with
  GreedyConfig greedy;
  double speed_mps = 0.1;            // of the strokes that planners imagine
  std::string device = "auto";       // of a policy's network
  const SafetyGate* gate = nullptr;  // whose refusals planners avoid; must outlive the agent
};

// `random`, `greedy`, `default` (the shipped policy) or a policy's .safetensors file. Throws Error
// that lists these for any other name.
std::unique_ptr<Agent> LoadAgent(const std::string& name_or_file, const AgentOptions& options);

}  // namespace sandwright
