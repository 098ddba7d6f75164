#include "agents/policy_file.h"

#include <spdlog/fmt/ranges.h>

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

}  // namespace

Safetensors PackPolicy(const ActorCritic& network, const PolicyCard& card) {
  PolicyCard copy = card;  // field lists point at what they describe
  Safetensors content;
  content.metadata = {
      {"schema", kSchema},
      {"schema_version", kVersion},
      {"network", ToJson(FieldsOf(copy.network)).dump()},
      {"observation", ToJson(FieldsOf(copy.observation)).dump()},
      {"observation_spec", SpecToJson(SpecOf(card.observation)).dump()},
      {"action_spec", ActionSpecToJson().dump()},
      {"region_m", nlohmann::json({card.region_width_m, card.region_depth_m}).dump()},
      {"seed", nlohmann::json(card.seed).dump()},
      {"steps", nlohmann::json(card.steps).dump()},
      {"config", card.config.dump()},
      {"commit", BuildCommit()}};
  SaveWeights(network, kPrefix, content);
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
  LoadJson(FieldsOf(card.network), read("network"), source);
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
  RandomStream unused(0);  // every weight is replaced
  policy.network =
      std::make_unique<ActorCritic>(SpecOf(card.observation), kActionSize, card.network, unused);
  LoadWeights(content, kPrefix, source, *policy.network);
  policy.network->to(device);
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
