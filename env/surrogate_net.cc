#include "env/surrogate_net.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "data/base/error.h"
#include "env/surrogate_encoding.h"

namespace sandwright {
namespace {

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

std::vector<ConvShape> SurrogateLayers(const SurrogateNetConfig& config) {
  const auto width = [&](int level) { return static_cast<int>(config.base_channels) << level; };
  const int poolings = static_cast<int>(config.poolings);
  const int patch = static_cast<int>(config.patch_cells * config.patch_cells);
  std::vector<ConvShape> layers;
  for (int level = 0; level <= poolings; ++level) {
    const int in = level == 0 ? kSurrogateChannelCount * patch : width(level - 1);
    layers.push_back({fmt::format("down{}a", level), in, width(level), 3, level});
    layers.push_back({fmt::format("down{}b", level), width(level), width(level), 3, level});
  }
  for (int level = poolings - 1; level >= 0; --level) {
    layers.push_back(
        {fmt::format("up{}a", level), width(level) + width(level + 1), width(level), 3, level});
    layers.push_back({fmt::format("up{}b", level), width(level), width(level), 3, level});
  }
  layers.push_back({"head", width(0), patch, 1});
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

CellFeatures SurrogateNet::PackPatches(std::span<const float> channels,
                                       const ActiveCells& active) const {
  const int patch = static_cast<int>(config_.patch_cells);
  const int rows = active.rows * patch, columns = active.columns * patch;
  const size_t plane = static_cast<size_t>(rows) * static_cast<size_t>(columns);
  SAND_CHECK(channels.size() == kSurrogateChannelCount * plane);
  CellFeatures packed(active.rows, active.columns, kSurrogateChannelCount * patch * patch, 1);
  for (int row = 0; row < rows; ++row) {
    const auto [first, end] = active.span[static_cast<size_t>(row / patch)];
    for (int c = 0; c < kSurrogateChannelCount; ++c) {
      const float* from = channels.data() + static_cast<size_t>(c) * plane +
                          static_cast<size_t>(row) * static_cast<size_t>(columns);
      const int channel = (c * patch + row % patch) * patch;
      for (int column = first; column < end; ++column)
        std::copy_n(from + column * patch, patch, packed.At(row / patch, column) + channel);
    }
    if (row % patch == patch - 1) packed.ClearInactive(active, row / patch);
  }
  return packed;
}

std::vector<float> SurrogateNet::Forward(std::span<const float> channels,
                                         const ActiveCells& active) const {
  SAND_CHECK(active.rows % config_.multiple() == 0 && active.columns % config_.multiple() == 0,
             active.rows, active.columns);
  const int poolings = static_cast<int>(config_.poolings);
  const int patch = static_cast<int>(config_.patch_cells);
  const auto width = [&](int level) { return static_cast<int>(config_.base_channels) << level; };
  std::vector<ActiveCells> levels{active.Coarser(patch)};
  for (int level = 0; level < poolings; ++level) levels.push_back(levels.back().Coarser(2));

  size_t next = 0;
  // `channels_out` leaves room behind what the layer writes.
  const auto convolve = [&](const CellFeatures& in, int level, int channels_out) {
    CellFeatures out(in.rows(), in.columns(), channels_out, 1);
    layers_[next++].Apply(in, levels[static_cast<size_t>(level)], true, out);
    return out;
  };
  CellFeatures current = PackPatches(channels, levels[0]);
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
  CellFeatures head(current.rows(), current.columns(), layers_[next].out(), 0);
  layers_[next].Apply(current, levels[0], false, head);

  std::vector<float> residual(active.cell.size(), 0.0f);
  for (int row = 0; row < active.rows; ++row) {
    const auto [first, end] = active.span[static_cast<size_t>(row)];
    for (int column = first; column < end; ++column) {
      const auto i = static_cast<size_t>(row * active.columns + column);
      if (active.cell[i])
        residual[i] = head.At(row / patch, column / patch)[row % patch * patch + column % patch];
    }
  }
  return residual;
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
