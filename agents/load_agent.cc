#include "agents/load_agent.h"

#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "agents/policy_agent.h"
#include "agents/random_agent.h"
#include "agents/ranked.h"
#include "data/base/error.h"
#include "data/shipped.h"

namespace sandwright {
namespace {

// data/models has a card of each.
constexpr std::array kShippedPolicies = {"default", "sampler", "walled"};

bool IsShipped(const std::string& name) { return std::ranges::find(kShippedPolicies, name) != kShippedPolicies.end(); }

std::filesystem::path PolicyPath(const std::string& name_or_file) {
  if (IsShipped(name_or_file)) return ShippedFile(fmt::format("models/{}_policy.safetensors", name_or_file));
  return name_or_file;
}

bool IsPolicy(const std::string& name_or_file) {
  return IsShipped(name_or_file) || name_or_file.ends_with(".safetensors");
}

std::unique_ptr<PolicyAgent> LoadPolicy(const std::string& name_or_file, const AgentOptions& options) {
  const std::filesystem::path file = PolicyPath(name_or_file);
  if (file.extension() != ".safetensors")
    throw Error(fmt::format("no policy '{}'; allowed: {} or a .safetensors file", name_or_file,
                            fmt::join(kShippedPolicies, ", ")));
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
  if (!IsPolicy(name))
    throw Error(fmt::format("no agent '{}' in this version; allowed: {}", name, kAgentNames));
  return LoadPolicy(name, options);
}

std::optional<std::filesystem::path> PolicyFileOf(const std::string& name_or_file, const PlannerConfigs& planners) {
  if (name_or_file == "ranked") return PolicyPath(planners.ranked.policy);
  if (IsPolicy(name_or_file)) return PolicyPath(name_or_file);
  return std::nullopt;
}

}  // namespace sandwright
