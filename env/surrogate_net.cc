#include "env/surrogate_net.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "data/base/error.h"
#include "env/surrogate_encoding.h"

namespace sandwright {
namespace {

constexpr int kChannelBlock = 4;  // output channels that are computed together
constexpr int kColumnBlock = 16;  // columns that are computed together: two vectors

// Planes with a border of zeros, so that no convolution asks where the edge is. Rows are long
// enough to write whole column blocks.
struct Planes {
  Planes(int channels, int rows_, int columns_)
      : rows(rows_),
        columns(columns_),
        stride((columns_ + kColumnBlock - 1) / kColumnBlock * kColumnBlock + 2),
        plane(static_cast<size_t>(rows_ + 2) * static_cast<size_t>(stride)),
        values(static_cast<size_t>(channels) * plane, 0.0f) {}
  float* Row(int channel, int row) {
    return &values[static_cast<size_t>(channel) * plane +
                   static_cast<size_t>(row + 1) * static_cast<size_t>(stride) + 1];
  }
  const float* Row(int channel, int row) const {
    return const_cast<Planes*>(this)->Row(channel, row);
  }

  int rows, columns, stride;
  size_t plane;
  std::vector<float> values;
};

// One row block: out[c][x] = relu(bias[c] + sum over in, 3 x 3) for four channels and kColumnBlock
// columns. `in` points at the upper left neighbour in the first input plane. Built for several
// instruction sets; the loader takes the best that the machine has.
__attribute__((target_clones("arch=haswell", "default"))) void ConvolveBlock(
    const float* in, int in_channels, size_t in_plane, int in_stride, const float* weights,
    const float* bias, float* const* out) {
  float sum0[kColumnBlock], sum1[kColumnBlock], sum2[kColumnBlock], sum3[kColumnBlock];
  for (int x = 0; x < kColumnBlock; ++x) {
    sum0[x] = bias[0];
    sum1[x] = bias[1];
    sum2[x] = bias[2];
    sum3[x] = bias[3];
  }
  for (int i = 0; i < in_channels; ++i, in += in_plane) {
    for (int ky = 0; ky < 3; ++ky) {
      const float* row = in + ky * in_stride;
      for (int kx = 0; kx < 3; ++kx, weights += kChannelBlock) {
        for (int x = 0; x < kColumnBlock; ++x) {
          const float value = row[kx + x];
          sum0[x] += weights[0] * value;
          sum1[x] += weights[1] * value;
          sum2[x] += weights[2] * value;
          sum3[x] += weights[3] * value;
        }
      }
    }
  }
  for (int x = 0; x < kColumnBlock; ++x) {
    out[0][x] = std::max(sum0[x], 0.0f);
    out[1][x] = std::max(sum1[x], 0.0f);
    out[2][x] = std::max(sum2[x], 0.0f);
    out[3][x] = std::max(sum3[x], 0.0f);
  }
}

// Reads `in`'s first in_channels planes, writes `out`'s planes from `first` on.
void Convolve(const Planes& in, int in_channels, const std::vector<float>& weights,
              const std::vector<float>& bias, Planes& out, int first) {
  const int blocks = static_cast<int>(bias.size()) / kChannelBlock;
  const size_t block_weights = static_cast<size_t>(in_channels) * 9 * kChannelBlock;
  for (int block = 0; block < blocks; ++block) {
    for (int row = 0; row < in.rows; ++row) {
      for (int column = 0; column < in.columns; column += kColumnBlock) {
        float* rows[kChannelBlock];
        for (int c = 0; c < kChannelBlock; ++c)
          rows[c] = out.Row(first + block * kChannelBlock + c, row) + column;
        ConvolveBlock(in.Row(0, row - 1) + column - 1, in_channels, in.plane, in.stride,
                      &weights[static_cast<size_t>(block) * block_weights],
                      &bias[static_cast<size_t>(block * kChannelBlock)], rows);
      }
      // What the last block wrote behind the row's end is border again.
      for (int c = 0; c < kChannelBlock; ++c) {
        float* values = out.Row(first + block * kChannelBlock + c, row);
        std::fill(values + in.columns, values + in.stride - 1, 0.0f);
      }
    }
  }
}

Planes Pool(const Planes& in, int channels) {
  Planes out(channels, in.rows / 2, in.columns / 2);
  for (int c = 0; c < channels; ++c) {
    for (int row = 0; row < out.rows; ++row) {
      const float *a = in.Row(c, 2 * row), *b = in.Row(c, 2 * row + 1);
      float* to = out.Row(c, row);
      for (int i = 0; i < out.columns; ++i)
        to[i] = 0.25f * (a[2 * i] + a[2 * i + 1] + b[2 * i] + b[2 * i + 1]);
    }
  }
  return out;
}

void Upsample(const Planes& in, int channels, Planes& out, int first) {
  for (int c = 0; c < channels; ++c) {
    for (int row = 0; row < out.rows; ++row) {
      const float* from = in.Row(c, row / 2);
      float* to = out.Row(first + c, row);
      for (int i = 0; i < out.columns; ++i) to[i] = from[i / 2];
    }
  }
}

}  // namespace

std::vector<ConvShape> SurrogateLayers(const SurrogateNetConfig& config) {
  if (config.base_channels % kChannelBlock != 0)
    throw Error(fmt::format("base_channels = {}; must be a multiple of {}", config.base_channels,
                            kChannelBlock));
  const auto width = [&](int level) { return static_cast<int>(config.base_channels) << level; };
  const int poolings = static_cast<int>(config.poolings);
  std::vector<ConvShape> layers;
  for (int level = 0; level <= poolings; ++level) {
    const int in = level == 0 ? kSurrogateChannelCount : width(level - 1);
    layers.push_back({fmt::format("down{}a", level), in, width(level)});
    layers.push_back({fmt::format("down{}b", level), width(level), width(level)});
  }
  for (int level = poolings - 1; level >= 0; --level) {
    layers.push_back({fmt::format("up{}a", level), width(level) + width(level + 1), width(level)});
    layers.push_back({fmt::format("up{}b", level), width(level), width(level)});
  }
  layers.push_back({"head", width(0), 1, 1});
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
  for (const ConvShape& shape : SurrogateLayers(config)) {
    Layer layer{shape, take(shape.name + ".weight", {shape.out, shape.in, shape.size, shape.size}),
                take(shape.name + ".bias", {shape.out})};
    if (shape.size == 3) {  // -> the order in which ConvolveBlock reads
      const std::vector<float> given = layer.weights;
      const size_t per_channel = static_cast<size_t>(shape.in) * 9;
      for (size_t i = 0; i < given.size(); ++i) {
        const size_t out = i / per_channel, rest = i % per_channel;
        layer.weights[(out / kChannelBlock * per_channel + rest) * kChannelBlock +
                      out % kChannelBlock] = given[i];
      }
    }
    layers_.push_back(std::move(layer));
  }
}

std::vector<float> SurrogateNet::Forward(std::span<const float> channels, int rows,
                                         int columns) const {
  SAND_CHECK(rows % config_.multiple() == 0 && columns % config_.multiple() == 0, rows, columns);
  SAND_CHECK(channels.size() == static_cast<size_t>(kSurrogateChannelCount) *
                                    static_cast<size_t>(rows) * static_cast<size_t>(columns));
  const int poolings = static_cast<int>(config_.poolings);
  const auto width = [&](int level) { return static_cast<int>(config_.base_channels) << level; };
  size_t next = 0;
  const auto convolve = [&](const Planes& in, Planes& out) {
    const Layer& layer = layers_[next++];
    Convolve(in, layer.shape.in, layer.weights, layer.bias, out, 0);
  };

  Planes current(kSurrogateChannelCount, rows, columns);
  for (int c = 0; c < kSurrogateChannelCount; ++c) {
    for (int row = 0; row < rows; ++row) {
      const auto from = channels.begin() + (static_cast<std::ptrdiff_t>(c) * rows + row) * columns;
      std::copy(from, from + columns, current.Row(c, row));
    }
  }
  std::vector<Planes> skips;  // each with room behind it for what comes up from below
  for (int level = 0; level <= poolings; ++level) {
    Planes first(width(level), current.rows, current.columns);
    convolve(current, first);
    const bool bottom = level == poolings;
    Planes second(bottom ? width(level) : width(level) + width(level + 1), first.rows,
                  first.columns);
    convolve(first, second);
    if (bottom) {
      current = std::move(second);
    } else {
      current = Pool(second, width(level));
      skips.push_back(std::move(second));
    }
  }
  for (int level = poolings - 1; level >= 0; --level) {
    Planes joined = std::move(skips.back());
    skips.pop_back();
    Upsample(current, width(level + 1), joined, width(level));
    Planes first(width(level), joined.rows, joined.columns), second = first;
    convolve(joined, first);
    convolve(first, second);
    current = std::move(second);
  }
  const Layer& head = layers_[next];
  std::vector<float> residual(static_cast<size_t>(rows) * static_cast<size_t>(columns),
                              head.bias[0]);
  for (int c = 0; c < head.shape.in; ++c) {
    for (int row = 0; row < rows; ++row) {
      const float* from = current.Row(c, row);
      float* to = &residual[static_cast<size_t>(row) * static_cast<size_t>(columns)];
      for (int i = 0; i < columns; ++i) to[i] += head.weights[static_cast<size_t>(c)] * from[i];
    }
  }
  return residual;
}

}  // namespace sandwright
