#include "env/surrogate_net.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "data/base/error.h"
#include "env/surrogate_encoding.h"

namespace sandwright {
namespace {

constexpr size_t kHarmonics = 5;
constexpr std::array<int, 6> kLinearChannels = {0, 1, 2, 7, 8, 11};  // see LinearFeatures

// Means of 2 x 2 cells, on the active ones of the coarser grid.
CellFeatures Pool(const CellFeatures& fine, int channels, const ActiveCells& active) {
  CellFeatures coarse(active.rows, active.columns, channels, 1);
  for (int row = 0; row < active.rows; ++row) {
    const auto [first, end] = active.span[static_cast<size_t>(row)];
    for (int column = first; column < end; ++column) {
      const float *a = fine.At(2 * row, 2 * column), *b = fine.At(2 * row, 2 * column + 1),
                  *c = fine.At(2 * row + 1, 2 * column), *d = fine.At(2 * row + 1, 2 * column + 1);
      float* to = coarse.At(row, column);
      for (int i = 0; i < channels; ++i) to[i] = 0.25f * (a[i] + b[i] + c[i] + d[i]);
    }
    coarse.ClearInactive(active, row);
  }
  return coarse;
}

// Repeats each coarse cell on its four, as channels `first_channel` and following.
void Upsample(const CellFeatures& coarse, int channels, const ActiveCells& active,
              CellFeatures& fine, int first_channel) {
  for (int row = 0; row < active.rows; ++row) {
    const auto [first, end] = active.span[static_cast<size_t>(row)];
    for (int column = first; column < end; ++column) {
      if (active.cell[static_cast<size_t>(row * active.columns + column)])
        std::copy_n(coarse.At(row / 2, column / 2), channels, fine.At(row, column) + first_channel);
    }
  }
}

}  // namespace

int SurrogateNetConfig::inputs() const {
  return linear() ? kLinearChannels.size() * kHarmonics : kSurrogateChannelCount;
}

int SurrogateNetConfig::outputs() const { return architecture == "flux" ? 2 : 1; }

std::vector<float> LinearFeatures(std::span<const float> channels, size_t cells) {
  SAND_CHECK(channels.size() == kSurrogateChannelCount * cells);
  std::vector<float> features(kLinearChannels.size() * kHarmonics * cells);
  for (size_t i = 0; i < cells; ++i) {
    const float x = channels[kDirectionXChannel * cells + i],
                y = channels[(kDirectionXChannel + 1) * cells + i], length = std::hypot(x, y);
    const float c = length > 0 ? x / length : 0, s = length > 0 ? y / length : 0;
    const std::array<float, kHarmonics> harmonics = {1, c, s, c * c - s * s, 2 * c * s};
    size_t feature = 0;
    for (const int channel : kLinearChannels) {
      for (const float harmonic : harmonics)
        features[feature++ * cells + i] =
            harmonic * channels[static_cast<size_t>(channel) * cells + i];
    }
  }
  return features;
}

std::vector<ConvShape> SurrogateLayers(const SurrogateNetConfig& config) {
  const auto width = [&](int level) { return static_cast<int>(config.base_channels) << level; };
  const int poolings = static_cast<int>(config.poolings);
  const int patch = static_cast<int>(config.patch_cells * config.patch_cells);
  const int inputs = config.inputs() * patch, outputs = config.outputs() * patch;
  if (config.linear()) {
    if (config.linear_cells % 2 == 0)
      throw Error(fmt::format("linear_cells = {}; must be odd", config.linear_cells));
    return {{"head", inputs, outputs, static_cast<int>(config.linear_cells), 0}};
  }
  std::vector<ConvShape> layers;
  for (int level = 0; level <= poolings; ++level) {
    const int in = level == 0 ? inputs : width(level - 1);
    layers.push_back({fmt::format("down{}a", level), in, width(level), 3, level});
    layers.push_back({fmt::format("down{}b", level), width(level), width(level), 3, level});
  }
  for (int level = poolings - 1; level >= 0; --level) {
    layers.push_back(
        {fmt::format("up{}a", level), width(level) + width(level + 1), width(level), 3, level});
    layers.push_back({fmt::format("up{}b", level), width(level), width(level), 3, level});
  }
  layers.push_back({"head", width(0), outputs, 1, 0});
  return layers;
}

SurrogateNet::SurrogateNet(const SurrogateNetConfig& config, const Safetensors& file,
                           const std::string& source)
    : config_(config) {
  const auto take = [&](const std::string& name, const std::vector<int64_t>& shape) {
    const NamedTensor& tensor = file.Tensor(name, source);
    if (tensor.shape != shape)
      throw Error(fmt::format("{}: tensor {} has shape {}; expected {}", source, name,
                              nlohmann::json(tensor.shape).dump(), nlohmann::json(shape).dump()));
    if (!std::ranges::all_of(tensor.values, [](float v) { return std::isfinite(v); }))
      throw Error(fmt::format("{}: tensor {} holds a value that is not finite", source, name));
    return tensor.values;
  };
  for (const ConvShape& shape : SurrogateLayers(config))
    layers_.emplace_back(
        shape.in, shape.out, shape.size,
        take(shape.name + ".weight", {shape.out, shape.in, shape.size, shape.size}),
        take(shape.name + ".bias", {shape.out}));
}

CellFeatures SurrogateNet::PackPatches(std::span<const float> inputs,
                                       const ActiveCells& active) const {
  const int patch = static_cast<int>(config_.patch_cells), channels = config_.inputs();
  const int rows = active.rows * patch, columns = active.columns * patch;
  const size_t plane = static_cast<size_t>(rows) * static_cast<size_t>(columns);
  SAND_CHECK(inputs.size() == static_cast<size_t>(channels) * plane);
  CellFeatures packed(active.rows, active.columns, channels * patch * patch,
                      layers_.front().size() / 2);
  for (int row = 0; row < rows; ++row) {
    const auto [first, end] = active.span[static_cast<size_t>(row / patch)];
    for (int c = 0; c < channels; ++c) {
      const float* from = inputs.data() + static_cast<size_t>(c) * plane +
                          static_cast<size_t>(row) * static_cast<size_t>(columns);
      const int channel = (c * patch + row % patch) * patch;
      for (int column = first; column < end; ++column)
        std::copy_n(from + column * patch, patch, packed.At(row / patch, column) + channel);
    }
    if (row % patch == patch - 1) packed.ClearInactive(active, row / patch);
  }
  return packed;
}

CellFeatures SurrogateNet::ForwardUNet(CellFeatures current,
                                       std::span<const ActiveCells> levels) const {
  const int poolings = static_cast<int>(config_.poolings);
  const auto width = [&](int level) { return static_cast<int>(config_.base_channels) << level; };
  size_t next = 0;
  // `channels_out` leaves room behind what the layer writes.
  const auto convolve = [&](const CellFeatures& in, int level, int channels_out) {
    CellFeatures out(in.rows(), in.columns(), channels_out, 1);
    layers_[next++].Apply(in, levels[static_cast<size_t>(level)], true, out);
    return out;
  };
  std::vector<CellFeatures> skips;
  for (int level = 0; level < poolings; ++level) {
    current = convolve(current, level, width(level));
    skips.push_back(convolve(current, level, width(level) + width(level + 1)));
    current = Pool(skips.back(), width(level), levels[static_cast<size_t>(level) + 1]);
  }
  current = convolve(current, poolings, width(poolings));
  current = convolve(current, poolings, width(poolings));
  for (int level = poolings - 1; level >= 0; --level) {
    CellFeatures joined = std::move(skips.back());
    skips.pop_back();
    Upsample(current, width(level + 1), levels[static_cast<size_t>(level)], joined, width(level));
    current = convolve(joined, level, width(level));
    current = convolve(current, level, width(level));
  }
  return current;
}

std::vector<float> SurrogateNet::Forward(std::span<const float> channels,
                                         const ActiveCells& active) const {
  SAND_CHECK(active.rows % config_.multiple() == 0 && active.columns % config_.multiple() == 0,
             active.rows, active.columns);
  const int patch = static_cast<int>(config_.patch_cells);
  std::vector<ActiveCells> levels{active.Coarser(patch)};
  const size_t cells = active.cell.size();
  CellFeatures features = config_.linear() ? PackPatches(LinearFeatures(channels, cells), levels[0])
                                           : PackPatches(channels, levels[0]);
  if (!config_.linear()) {
    for (int level = 0; level < config_.poolings; ++level)
      levels.push_back(levels.back().Coarser(2));
    features = ForwardUNet(std::move(features), levels);
  }
  CellFeatures head(features.rows(), features.columns(), layers_.back().out(), 0);
  layers_.back().Apply(features, levels[0], false, head);

  std::vector<float> result(static_cast<size_t>(config_.outputs()) * cells, 0.0f);
  for (int row = 0; row < active.rows; ++row) {
    const auto [first, end] = active.span[static_cast<size_t>(row)];
    for (int column = first; column < end; ++column) {
      const auto i = static_cast<size_t>(row * active.columns + column);
      if (!active.cell[i]) continue;
      const float* from = head.At(row / patch, column / patch);
      for (int o = 0; o < config_.outputs(); ++o)
        result[static_cast<size_t>(o) * cells + i] =
            from[(o * patch + row % patch) * patch + column % patch];
    }
  }
  return result;
}

double SurrogateNet::Flops(const ActiveCells& active) const {
  double flops = 0;
  for (const ConvShape& shape : SurrogateLayers(config_)) {
    const ActiveCells coarse = active.Coarser(static_cast<int>(config_.patch_cells) << shape.level);
    flops += 2.0 * shape.in * shape.out * shape.size * shape.size *
             static_cast<double>(std::ranges::count(coarse.cell, 1));
  }
  return flops;
}

}  // namespace sandwright
