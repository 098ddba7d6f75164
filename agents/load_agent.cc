#include "agents/load_agent.h"

#include <filesystem>

#include "agents/policy_agent.h"
#include "agents/random_agent.h"
#include "data/base/error.h"
#include "data/shipped.h"

namespace sandwright {

std::unique_ptr<Agent> LoadAgent(const std::string& name_or_file, const AgentOptions& options) {
  if (name_or_file == "random") return std::make_unique<RandomAgent>();
  if (name_or_file == "greedy")
    return std::make_unique<GreedyAgent>(options.model, options.greedy, options.speed_mps,
                                         options.gate);
  std::filesystem::path file = name_or_file;
  if (name_or_file == "default") file = ShippedFile("models/default_policy.safetensors");
  if (file.extension() != ".safetensors")
    throw Error(
        "no agent '" + name_or_file +
        "' in this version; allowed: random, greedy, default or a .safetensors file of a policy");
  const torch::Device device = SelectDevice(options.device);
  return std::make_unique<PolicyAgent>(
      name_or_file, UnpackPolicy(ReadSafetensors(file), file.string(), device), device);
}

}  // namespace sandwright
