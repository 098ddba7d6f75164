#include "env/surrogate.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "data/base/parallel.h"
#include "env/avalanche.h"
#include "env/blade_path.h"
#include "env/coarse_heightfield.h"
#include "env/model_config.h"
#include "env/surrogate_encoding.h"
#include "env/surrogate_paste.h"

namespace sandwright {
namespace {

bool CutsSand(const SurrogateInput& input) {
  const size_t plane = input.active.size();
  const auto cut = input.channels.begin() + static_cast<ptrdiff_t>(kCutChannel * plane);
  return std::any_of(cut, cut + static_cast<ptrdiff_t>(plane), [](float v) { return v > 0; });
}

// Nothing flows between a cell that the stroke reaches and one that it does not.
void CloseFacesOfTheReach(const SurrogateInput& input, std::vector<double>& flux_m) {
  const int rows = input.window.rows(), columns = input.window.columns();
  const auto active = [&](int row, int column) {
    return input.active[static_cast<size_t>(row * input.columns + column)] != 0;
  };
  const auto cells = static_cast<size_t>(rows * columns);
  size_t i = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column, ++i) {
      if (column + 1 < columns && !active(row, column + 1)) flux_m[i] = 0;
      if (row + 1 < rows && !active(row + 1, column)) flux_m[cells + i] = 0;
    }
  }
}

}  // namespace

Surrogate::Surrogate(const SurrogateConfig& config, const Safetensors& parameters,
                     const std::string& source)
    : config_(config), heightfield_(config.heightfield), net_(config.net, parameters, source) {
  if (TrainingRange::In(parameters)) range_.emplace(parameters, source);
}

std::vector<Outcome> Surrogate::ApplyChecked(std::span<SandState> states,
                                             std::span<const ToolPath> paths) const {
  std::vector<Outcome> outcomes(states.size());
  // Each stroke from beginning to end on one thread, so that none waits for the others in between.
  ParallelFor(static_cast<int>(states.size()), static_cast<int>(config_.threads), [&](int index) {
    const auto i = static_cast<size_t>(index);
    const SandState before = states[i];
    if (config_.net.uses_heightfield()) {
      outcomes[i] = ApplyOnCoarseCells(
          heightfield_, static_cast<int>(config_.heightfield_cells), states[i], paths[i]);
      if (outcomes[i].moved_volume_m3 == 0) return;  // it touches no sand and changes none
    } else {
      const LimitedPath limited = LimitPath(paths[i], blade(), before.map());
      outcomes[i].left_box = limited.left_box;
      outcomes[i].below_floor = limited.below_floor;
    }
    Correct(before.map(), paths[i], states[i], outcomes[i]);
  });
  return outcomes;
}

void Surrogate::Correct(const HeightMap& before, const ToolPath& path, SandState& state,
                        Outcome& outcome) const {
  const SurrogateInput input =
      EncodeStroke(before, state.map(), path, blade(), config_.net.multiple(), config_.reach_m);
  if (input.window.empty()) return;
  if (!config_.net.uses_heightfield() && !CutsSand(input)) return;
  if (range_) outcome.training_distance = range_->Distance(input);
  const std::vector<float> said =
      net_.Forward(input.channels, ActiveCells(input.rows, input.columns, input.active));
  const int rows = input.window.rows(), columns = input.window.columns();
  std::vector<double> said_m;  // [outputs, rows, columns] of the window, without its padding
  for (int o = 0; o < config_.net.outputs(); ++o) {
    for (int row = 0; row < rows; ++row) {
      const auto from =
          said.begin() + (static_cast<ptrdiff_t>(o) * input.rows + row) * input.columns;
      std::transform(from, from + columns, std::back_inserter(said_m),
                     [](float value) { return kResidualScale_m * value; });
    }
  }
  HeightMap map = state.map();
  if (config_.net.architecture == "flux") {
    CloseFacesOfTheReach(input, said_m);
    AddFluxes(input.window, said_m, map);
  } else {
    AddResidual(input.window, std::move(said_m), config_.conserve_volume, map);
  }
  outcome.changed = Union(outcome.changed, input.window);
  if (config_.steepest_over_repose > 0)
    outcome.changed = Union(
        outcome.changed,
        LimitSlopes(map, input.window,
                    config_.steepest_over_repose *
                        std::tan(config_.heightfield.repose_deg * std::numbers::pi / 180)));
  outcome.moved_volume_m3 = MovedVolume(before, map, outcome.changed);
  state.Replace(std::move(map));
}

SurrogateConfig SurrogateConfigOf(const Safetensors& content, const std::string& source) {
  const auto schema = content.metadata.find("schema");
  if (schema == content.metadata.end() || schema->second != "sandwright-surrogate")
    throw Error(fmt::format(
        "{}: not a surrogate (metadata schema is \"{}\"; expected sandwright-surrogate)", source,
        schema == content.metadata.end() ? "" : schema->second));
  SurrogateConfig config;
  LoadModelConfig(content, source, FieldsOf(config));
  return config;
}

Surrogate ReadSurrogate(const Safetensors& content, const std::string& source, int64_t threads) {
  SurrogateConfig config = SurrogateConfigOf(content, source);
  config.threads = config.heightfield.threads = threads;
  return Surrogate(config, content, source);
}

Surrogate ReadSurrogate(const std::filesystem::path& file, int64_t threads) {
  return ReadSurrogate(ReadSafetensors(file), file.string(), threads);
}

}  // namespace sandwright
