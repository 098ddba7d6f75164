// Trained policies on disk: one safetensors file that needs no configuration beside it.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "agents/networks.h"
#include "agents/sac_config.h"
#include "env/observation.h"
#include "env/safetensors.h"

namespace sandwright {

// What a policy was made for and how.
struct PolicyCard {
  std::variant<NetworkConfig, SacNetworkConfig> network;  // an ActorCritic's or a SquashedActor's
  ObservationConfig observation;
  double region_width_m = 0, region_depth_m = 0;  // extent of the region it acts in
  uint64_t seed = 0;
  int64_t steps = 0;      // strokes it was trained on
  nlohmann::json config;  // of the whole training run, resolved
};

struct Policy {
  PolicyCard card;
  std::unique_ptr<Actor> actor;
};

// Weights, card, specs of observation and action, and the program's commit.
Safetensors PackPolicy(const Actor& actor, const PolicyCard& card);

// Throws Error naming `source` and what differs: another kind of file, other observation channels
// or action entries than this program's, weights of another network.
Policy UnpackPolicy(const Safetensors& content, const std::string& source, torch::Device device);

// Only the weights, into a network made alike; residual blocks that the file lacks stay as they are (a new
// network's: the identity). Throws Error naming `source` and what differs.
void LoadPolicyWeights(const Safetensors& content, const std::string& source, ActorCritic& network);

}  // namespace sandwright
