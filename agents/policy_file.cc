#include "agents/policy_file.h"

#include <spdlog/fmt/ranges.h>

#include "agents/squashed_actor.h"
#include "agents/trainer.h"
#include "data/base/error.h"
#include "data/base/machine.h"
#include "env/action.h"

namespace sandwright {
namespace {

constexpr const char* kSchema = "sandwright-policy";
constexpr const char* kVersion = "2";
constexpr const char* kPrefix = "network.";  // of the weights; a checkpoint holds other tensors too
constexpr const char* kBlocks = "block";
// What kind of actor the weights are of; files without it are of the first.
constexpr const char* kKind = "actor";
constexpr const char* kPlaces = "places";
constexpr const char* kSquashed = "squashed";

nlohmann::json SpecToJson(const ObservationSpec& spec) {
  return {{"channels", spec.channels},
          {"rows", spec.rows},
          {"columns", spec.columns},
          {"numbers", spec.numbers}};
}

nlohmann::json ActionSpecToJson() {
  auto entries = nlohmann::json::array();
  for (const ActionEntry& e : kActionSpec)
    entries.push_back({{"name", e.name}, {"low", e.low}, {"high", e.high}});
  return entries;
}

void CheckSame(const nlohmann::json& saved, const nlohmann::json& ours, const char* what,
               const std::string& source) {
  if (saved != ours)
    throw Error(fmt::format("{}: the policy's {} is {}; this program's is {}", source, what,
                            saved.dump(), ours.dump()));
}

std::unique_ptr<Actor> MakeActor(const PolicyCard& card) {
  const ObservationSpec spec = SpecOf(card.observation);
  RandomStream unused(0);  // every weight is replaced
  if (const auto* places = std::get_if<NetworkConfig>(&card.network))
    return std::make_unique<ActorCritic>(spec, kActionSize, *places, unused);
  const auto& sizes = std::get<SacNetworkConfig>(card.network);
  return std::make_unique<SquashedActor>(
      std::make_shared<MapEncoder>(spec, sizes.channels, sizes.features, unused), kActionSize,
      sizes.hidden, unused);
}

}  // namespace

Safetensors PackPolicy(const Actor& actor, const PolicyCard& card) {
  PolicyCard copy = card;  // field lists point at what they describe
  const bool squashed = std::holds_alternative<SacNetworkConfig>(card.network);
  Safetensors content;
  content.metadata = {
      {"schema", kSchema},
      {"schema_version", kVersion},
      {kKind, squashed ? kSquashed : kPlaces},
      {"network", std::visit([](auto& n) { return ToJson(FieldsOf(n)).dump(); }, copy.network)},
      {"observation", ToJson(FieldsOf(copy.observation)).dump()},
      {"observation_spec", SpecToJson(SpecOf(card.observation)).dump()},
      {"action_spec", ActionSpecToJson().dump()},
      {"region_m", nlohmann::json({card.region_width_m, card.region_depth_m}).dump()},
      {"seed", nlohmann::json(card.seed).dump()},
      {"steps", nlohmann::json(card.steps).dump()},
      {"config", card.config.dump()},
      {"commit", BuildCommit()}};
  SaveWeights(actor, kPrefix, content);
  return content;
}

Policy UnpackPolicy(const Safetensors& content, const std::string& source, torch::Device device) {
  const auto schema = content.metadata.find("schema");
  if (schema == content.metadata.end() || schema->second != kSchema)
    throw Error(fmt::format("{}: not a policy: schema is '{}', allowed: '{}'", source,
                            schema == content.metadata.end() ? "" : schema->second, kSchema));
  if (const auto& version = content.Metadata("schema_version", source); version != kVersion)
    throw Error(fmt::format("{}: schema_version {} is not readable; allowed: {}", source, version,
                            kVersion));
  Policy policy;
  PolicyCard& card = policy.card;
  const auto read = [&](const char* key) { return ParsedMetadata(content, key, source); };
  const auto kind = content.metadata.find(kKind);
  if (kind != content.metadata.end() && kind->second == kSquashed)
    card.network = SacNetworkConfig{};
  else if (kind != content.metadata.end() && kind->second != kPlaces)
    throw Error(fmt::format("{}: the policy is of an actor '{}'; allowed: {}, {}", source,
                            kind->second, kPlaces, kSquashed));
  std::visit([&](auto& n) { LoadJson(FieldsOf(n), read("network"), source); }, card.network);
  LoadJson(FieldsOf(card.observation), read("observation"), source);
  CheckSame(read("observation_spec"), SpecToJson(SpecOf(card.observation)), "observation", source);
  CheckSame(read("action_spec"), ActionSpecToJson(), "action", source);
  try {
    card.region_width_m = read("region_m").at(0);
    card.region_depth_m = read("region_m").at(1);
    card.seed = read("seed");
    card.steps = read("steps");
  } catch (const nlohmann::json::exception& e) {
    throw Error(fmt::format("{}: damaged metadata: {}", source, e.what()));
  }
  card.config = read("config");
  policy.actor = MakeActor(card);
  LoadWeights(content, kPrefix, source, *policy.actor);
  policy.actor->to(device);
  return policy;
}

void LoadPolicyWeights(const Safetensors& content, const std::string& source,
                       ActorCritic& network) {
  Safetensors whole = content, own;
  SaveWeights(network, kPrefix, own);
  for (const auto& [name, weights] : own.tensors)
    if (name.starts_with(std::string(kPrefix) + kBlocks)) whole.tensors.try_emplace(name, weights);
  LoadWeights(whole, kPrefix, source, network);
}

}  // namespace sandwright
