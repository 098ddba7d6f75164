#include "env/surrogate.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "data/base/parallel.h"
#include "env/surrogate_encoding.h"

namespace sandwright {

void AddResidual(const CellRect& rect, std::vector<double> residual_m, bool conserve_volume,
                 HeightMap& map) {
  SAND_CHECK(residual_m.size() ==
             static_cast<size_t>(rect.rows()) * static_cast<size_t>(rect.columns()));
  const auto for_each = [&](const auto& body) {
    size_t i = 0;
    for (int row = rect.row0; row < rect.row1; ++row) {
      for (int column = rect.column0; column < rect.column1; ++column, ++i)
        body(residual_m[i], map.At(row, column));
    }
  };
  const bool floor_known = map.datum == Datum::kFloor;
  double inflow = 0, outflow = 0;
  for_each([&](double& residual, float height) {
    if (floor_known) residual = std::max(residual, -std::max(static_cast<double>(height), 0.0));
    (residual > 0 ? inflow : outflow) += std::abs(residual);
  });
  const double kept = std::min(inflow, outflow);
  for_each([&](double residual, float& height) {
    if (conserve_volume && residual != 0) residual *= kept / (residual > 0 ? inflow : outflow);
    height = static_cast<float>(height + residual);
  });
}

Surrogate::Surrogate(const SurrogateConfig& config, const Safetensors& parameters,
                     const std::string& source)
    : config_(config), heightfield_(config.heightfield), net_(config.net, parameters, source) {}

std::vector<Outcome> Surrogate::ApplyChecked(std::span<SandState> states,
                                             std::span<const ToolPath> paths) const {
  const std::vector<SandState> before(states.begin(), states.end());
  std::vector<Outcome> outcomes = heightfield_.Apply(states, paths);
  ParallelFor(static_cast<int>(states.size()), static_cast<int>(config_.threads), [&](int index) {
    const auto i = static_cast<size_t>(index);
    Correct(before[i].map(), paths[i], states[i], outcomes[i]);
  });
  return outcomes;
}

void Surrogate::Correct(const HeightMap& before, const ToolPath& path, SandState& state,
                        Outcome& outcome) const {
  // A stroke that touches no sand changes none.
  if (outcome.moved_volume_m3 == 0) return;
  const SurrogateInput input =
      EncodeStroke(before, state.map(), path, blade(), config_.net.multiple(), config_.reach_m);
  if (input.window.empty()) return;
  const std::vector<float> residual =
      net_.Forward(input.channels, ActiveCells(input.rows, input.columns, input.active));
  std::vector<double> residual_m;
  for (int row = 0; row < input.window.rows(); ++row) {
    for (int column = 0; column < input.window.columns(); ++column)
      residual_m.push_back(kResidualScale_m *
                           residual[static_cast<size_t>(row * input.columns + column)]);
  }
  HeightMap map = state.map();
  AddResidual(input.window, std::move(residual_m), config_.conserve_volume, map);
  outcome.changed = Union(outcome.changed, input.window);
  outcome.moved_volume_m3 = MovedVolume(before, map, outcome.changed);
  state.Replace(std::move(map));
}

Surrogate ReadSurrogate(const std::filesystem::path& file, int64_t threads) {
  const std::string source = file.string();
  const Safetensors content = ReadSafetensors(file);
  const auto schema = content.metadata.find("schema");
  if (schema == content.metadata.end() || schema->second != "sandwright-surrogate")
    throw Error(fmt::format(
        "{}: not a surrogate (metadata schema is \"{}\"; expected sandwright-surrogate)", source,
        schema == content.metadata.end() ? "" : schema->second));
  SurrogateConfig config;
  nlohmann::json json;
  try {
    json = nlohmann::json::parse(content.Metadata("config", source));
  } catch (const nlohmann::json::exception& e) {
    throw Error(fmt::format("{}: metadata config is not JSON: {}", source, e.what()));
  }
  LoadJson(FieldsOf(config), json, source + ": config");
  config.threads = config.heightfield.threads = threads;
  return Surrogate(config, content, source);
}

}  // namespace sandwright
