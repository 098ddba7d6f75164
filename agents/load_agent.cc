#include "agents/load_agent.h"

#include <spdlog/fmt/fmt.h>

#include <filesystem>

#include "agents/policy_agent.h"
#include "agents/random_agent.h"
#include "agents/ranked.h"
#include "data/base/error.h"
#include "data/shipped.h"

namespace sandwright {
namespace {

std::filesystem::path PolicyPath(const std::string& name_or_file) {
  if (name_or_file == "default") return ShippedFile("models/default_policy.safetensors");
  if (name_or_file == "sampler") return ShippedFile("models/sampler_policy.safetensors");
  return name_or_file;
}

std::unique_ptr<PolicyAgent> LoadPolicy(const std::string& name_or_file, const AgentOptions& options) {
  const std::filesystem::path file = PolicyPath(name_or_file);
  if (file.extension() != ".safetensors")
    throw Error(fmt::format("no policy '{}'; allowed: default, sampler or a .safetensors file", name_or_file));
  const torch::Device device = SelectDevice(options.device);
  return std::make_unique<PolicyAgent>(
      name_or_file, UnpackPolicy(ReadSafetensors(file), file.string(), device), device);
}

}  // namespace

std::unique_ptr<Agent> LoadAgent(const std::string& name_or_file, const AgentOptions& options) {
  const PlannerTool tool{options.model.blade(), options.speed_mps, options.gate};
  const StrokeJudge judge(options.model, options.speed_mps, options.gate);
  const PlannerConfigs& planners = options.planners;
  const std::string& name = name_or_file;
  if (name == "random") return std::make_unique<RandomAgent>();
  if (name == "boustrophedon")
    return std::make_unique<BoustrophedonAgent>(tool, planners.boustrophedon);
  if (name == "sweep") return std::make_unique<SweepAgent>(tool, planners.sweep);
  if (name == "greedy") return std::make_unique<GreedyAgent>(judge, planners.greedy);
  if (name == "cem") return std::make_unique<CemAgent>(judge, planners.cem);
  if (name == "ga") return std::make_unique<GaAgent>(judge, planners.ga);
  if (name == "ranked")
    return std::make_unique<RankedAgent>(judge, LoadPolicy(planners.ranked.policy, options),
                                         planners.ranked);
  if (name != "default" && !name.ends_with(".safetensors"))
    throw Error(fmt::format("no agent '{}' in this version; allowed: {}", name, kAgentNames));
  return LoadPolicy(name, options);
}

std::optional<std::filesystem::path> PolicyFileOf(const std::string& name_or_file, const PlannerConfigs& planners) {
  if (name_or_file == "ranked") return PolicyPath(planners.ranked.policy);
  if (name_or_file == "default" || name_or_file.ends_with(".safetensors")) return PolicyPath(name_or_file);
  return std::nullopt;
}

}  // namespace sandwright
