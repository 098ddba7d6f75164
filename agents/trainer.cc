#include "agents/trainer.h"

#include <spdlog/fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {

// Parameters first, then buffers; the tensors are handles to the module's own.
std::vector<std::pair<std::string, torch::Tensor>> WeightsOf(const torch::nn::Module& module) {
  std::vector<std::pair<std::string, torch::Tensor>> weights;
  for (const auto& item : module.named_parameters()) weights.emplace_back(item.key(), item.value());
  for (const auto& item : module.named_buffers()) weights.emplace_back(item.key(), item.value());
  return weights;
}

}  // namespace

std::map<std::string, double> EpisodeScalars(std::span<const EpisodeSummary> finished) {
  std::map<std::string, double> scalars;
  const auto count = static_cast<double>(finished.size());
  for (const EpisodeSummary& episode : finished) {
    scalars["rollout/ep_rew_mean"] += episode.episode_return / count;
    scalars["rollout/ep_len_mean"] += episode.length / count;
    for (const auto& [name, value] : episode.metrics)
      scalars["rollout/" + (name == "success" ? "success_rate" : name)] += value / count;
  }
  return scalars;
}

nlohmann::json EpisodesToJson(std::span<const EpisodeSummary> episodes) {
  auto json = nlohmann::json::array();
  for (const auto& [episode_return, length, metrics] : episodes)
    json.push_back({episode_return, length, metrics});
  return json;
}

std::vector<EpisodeSummary> EpisodesFromJson(const nlohmann::json& json) {
  std::vector<EpisodeSummary> episodes;
  for (const auto& episode : json)
    episodes.push_back({episode[0].get<double>(), episode[1].get<int>(),
                        episode[2].get<std::map<std::string, double>>()});
  return episodes;
}

void CheckFinite(const StepBatch& step) {
  const auto finite = [](float value) { return std::isfinite(value); };
  SAND_CHECK(std::ranges::all_of(step.reward, finite), "the environment gave a reward that is NaN");
  SAND_CHECK(std::ranges::all_of(step.observation.map, finite) &&
                 std::ranges::all_of(step.observation.vec, finite),
             "the environment gave an observation that is NaN");
}

uint64_t EpisodesSeed(uint64_t seed, int64_t steps) {
  return RandomStream(seed, StreamId("training episodes"), static_cast<uint64_t>(steps)).Next64();
}

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double AdaptedRate(double rate, double kl, double target_kl) {
  constexpr double kFactor = 1.5, kLowest = 1e-6, kHighest = 1e-2;
  if (kl > 2 * target_kl) return std::max(kLowest, rate / kFactor);
  if (kl < 0.5 * target_kl) return std::min(kHighest, rate * kFactor);
  return rate;
}

double ShareLeft(const std::string& schedule, int64_t steps, int64_t total_steps) {
  if (schedule == "constant") return 1;
  const auto total = static_cast<double>(std::max<int64_t>(total_steps, 1));
  return std::max(0.0, 1.0 - static_cast<double>(steps) / total);
}

nlohmann::json StreamToJson(const RandomStream& stream) {
  const auto& s = stream.state();
  // A block that is used up tells nothing, and before the first draw it is whatever memory held.
  const auto block = s.used == s.block.size() ? decltype(s.block){} : s.block;
  return {{"key", s.key}, {"counter", s.counter}, {"block", block}, {"used", s.used}};
}

RandomStream StreamFromJson(const nlohmann::json& json) {
  RandomStream::State s{};
  json.at("key").get_to(s.key);
  json.at("counter").get_to(s.counter);
  json.at("block").get_to(s.block);
  json.at("used").get_to(s.used);
  return RandomStream(s);
}

nlohmann::json StreamsToJson(std::span<const RandomStream> streams) {
  auto json = nlohmann::json::array();
  for (const RandomStream& stream : streams) json.push_back(StreamToJson(stream));
  return json;
}

void StreamsFromJson(const nlohmann::json& json, const std::string& source,
                     std::span<RandomStream> streams) {
  if (json.size() != streams.size())
    throw Error(fmt::format("{}: saved with another number of environments ({} instead of {})", source,
                            json.size(), streams.size()));
  for (size_t i = 0; i < streams.size(); ++i) streams[i] = StreamFromJson(json[i]);
}

nlohmann::json ParsedMetadata(const Safetensors& content, const std::string& key,
                              const std::string& source) {
  try {
    return nlohmann::json::parse(content.Metadata(key, source));
  } catch (const nlohmann::json::exception& e) {
    throw Error(fmt::format("{}: metadata '{}' is damaged: {}", source, key, e.what()));
  }
}

void SaveWeights(const torch::nn::Module& module, const std::string& prefix, Safetensors& content) {
  for (const auto& [name, weights] : WeightsOf(module)) {
    const auto cpu = weights.detach().to(torch::kCPU).contiguous();
    content.tensors[prefix + name] = {
        cpu.sizes().vec(), {cpu.data_ptr<float>(), cpu.data_ptr<float>() + cpu.numel()}};
  }
}

void LoadWeights(const Safetensors& content, const std::string& prefix, const std::string& source,
                 torch::nn::Module& module) {
  const torch::NoGradGuard no_grad;
  std::vector<torch::Tensor> loaded;
  const auto all = WeightsOf(module);
  for (const auto& [name, weights] : all) {
    const NamedTensor& saved = content.Tensor(prefix + name, source);
    if (saved.shape != weights.sizes().vec())
      throw Error(fmt::format("{}: weights '{}' have shape [{}], the network needs [{}]", source,
                              name, fmt::join(saved.shape, ", "),
                              fmt::join(weights.sizes().vec(), ", ")));
    loaded.push_back(torch::tensor(saved.values).view(saved.shape));
    if (!torch::isfinite(loaded.back()).all().item<bool>())
      throw Error(fmt::format("{}: weights '{}' are not finite", source, name));
  }
  for (size_t i = 0; i < all.size(); ++i) torch::Tensor(all[i].second).copy_(loaded[i]);
}

}  // namespace sandwright
