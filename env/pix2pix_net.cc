#include "env/pix2pix_net.h"

#include <algorithm>

#include "env/training_net.h"

namespace sandwright {
namespace {

constexpr int64_t kKernel = 4;
constexpr double kDeviation = 0.02;  // of the initial weights
constexpr double kLeak = 0.2;        // slope of the leaky ReLUs below zero
constexpr double kDropout = 0.5;
constexpr size_t kHalvings = 8, kDropouts = 3;

}  // namespace

Pix2PixLayers::Pix2PixLayers(std::vector<Pix2PixLayer> shapes) : shapes_(std::move(shapes)) {
  for (const Pix2PixLayer& shape : shapes_) {
    first_.push_back(parameters_.size());
    const auto add = [&](const char* name, std::vector<int64_t> sizes) {
      names_.push_back(shape.name + name);
      parameters_.push_back(torch::zeros(sizes));
    };
    const auto [first, second] =
        shape.up ? std::pair(shape.in, shape.out) : std::pair(shape.out, shape.in);
    add(".weight", {first, second, kKernel, kKernel});
    if (shape.normalised) add(".scale", {shape.out});
    add(shape.normalised ? ".shift" : ".bias", {shape.out});
  }
}

Pix2PixLayers::Pix2PixLayers(std::vector<Pix2PixLayer> shapes, RandomStream stream)
    : Pix2PixLayers(std::move(shapes)) {
  for (size_t i = 0; i < parameters_.size(); ++i) {
    const bool scale = names_[i].ends_with(".scale");
    if (!scale && !names_[i].ends_with(".weight")) continue;
    float* values = parameters_[i].data_ptr<float>();
    for (int64_t k = 0; k < parameters_[i].numel(); ++k)
      values[k] = static_cast<float>((scale ? 1 : 0) + kDeviation * stream.Normal());
  }
}

Pix2PixLayers::Pix2PixLayers(std::vector<Pix2PixLayer> shapes, const Safetensors& file,
                             const std::string& source)
    : Pix2PixLayers(std::move(shapes)) {
  for (size_t i = 0; i < parameters_.size(); ++i) {
    const NamedTensor& tensor = file.Tensor(names_[i], source);
    if (tensor.shape != parameters_[i].sizes().vec())
      throw Error(source + ": tensor " + names_[i] + " has another shape than the configured net");
    std::ranges::copy(tensor.values, parameters_[i].data_ptr<float>());
    if (!torch::isfinite(parameters_[i]).all().item<bool>())
      throw Error(source + ": tensor " + names_[i] + " holds numbers that are not finite");
  }
}

torch::Tensor Pix2PixLayers::Run(size_t layer, const torch::Tensor& x) const {
  const Pix2PixLayer& shape = shapes_[layer];
  const torch::Tensor* own = &parameters_[first_[layer]];
  const torch::Tensor bias = shape.normalised ? torch::Tensor() : own[1];
  const torch::Tensor y = shape.up ? torch::conv_transpose2d(x, own[0], bias, shape.stride, 1)
                                   : torch::conv2d(x, own[0], bias, shape.stride, 1);
  if (!shape.normalised) return y;
  return torch::instance_norm(y, own[1], own[2], {}, {}, true, 0, 1e-5, false);
}

void Pix2PixLayers::Save(const std::vector<torch::Tensor>& values, Safetensors& file) const {
  SAND_CHECK(values.size() == names_.size(), values.size(), names_.size());
  for (size_t i = 0; i < names_.size(); ++i) file.tensors[names_[i]] = ToNamed(values[i]);
}

std::vector<Pix2PixLayer> Pix2PixGenerator::Shapes(int64_t channels) {
  const auto width = [&](size_t level) {  // channels behind halving `level`, counted from 0
    return channels << std::min<size_t>(level, 3);
  };
  std::vector<Pix2PixLayer> shapes;
  for (size_t i = 0; i < kHalvings; ++i)
    shapes.push_back({.name = "down" + std::to_string(i + 1),
                      .in = i == 0 ? 3 : width(i - 1),
                      .out = width(i),
                      // The innermost is a single pixel, which a norm would make zero.
                      .normalised = i > 0 && i + 1 < kHalvings});
  for (size_t i = kHalvings; i-- > 0;)
    shapes.push_back({.name = "up" + std::to_string(i + 1),
                      .in = width(i) * (i + 1 == kHalvings ? 1 : 2),
                      .out = i == 0 ? 1 : width(i - 1),
                      .up = true,
                      .normalised = i > 0});
  return shapes;
}

torch::Tensor Pix2PixGenerator::Forward(const torch::Tensor& input,
                                        std::optional<at::Generator> dropout) const {
  std::vector<torch::Tensor> skips;
  torch::Tensor x = input;
  for (size_t i = 0; i < kHalvings; ++i) {
    x = layers_.Run(i, i == 0 ? x : torch::leaky_relu(x, kLeak));
    skips.push_back(x);
  }
  for (size_t i = 0; i < kHalvings; ++i) {
    if (i > 0) x = torch::cat({x, skips[kHalvings - 1 - i]}, 1);
    x = layers_.Run(kHalvings + i, torch::relu(x));
    if (dropout && i < kDropouts)
      x = x * torch::empty_like(x).bernoulli_(1 - kDropout, dropout) / (1 - kDropout);
  }
  return torch::tanh(x);
}

std::vector<Pix2PixLayer> Pix2PixDiscriminator::Shapes(int64_t channels) {
  return {{"judge1", 4, channels, 2, false, false},
          {"judge2", channels, 2 * channels, 2, false, true},
          {"judge3", 2 * channels, 4 * channels, 2, false, true},
          {"judge4", 4 * channels, 8 * channels, 1, false, true},
          {"judge5", 8 * channels, 1, 1, false, false}};
}

torch::Tensor Pix2PixDiscriminator::Forward(const torch::Tensor& input,
                                            const torch::Tensor& answer) const {
  torch::Tensor x = layers_.Run(0, torch::cat({input, answer}, 1));
  for (size_t i = 1; i < layers_.shapes().size(); ++i)
    x = layers_.Run(i, torch::leaky_relu(x, kLeak));
  return x;
}

torch::Tensor PaperTensor(const PaperPlane& plane) {
  const auto levels = torch::from_blob(const_cast<uint8_t*>(plane.data()),
                                       {1, 1, kPaperPixels, kPaperPixels}, torch::kUInt8);
  return levels.to(torch::kFloat) / 127.5 - 1;
}

torch::Tensor PaperTensor(const PaperInput& input) {
  return torch::cat({PaperTensor(input.height), PaperTensor(input.path), PaperTensor(input.depth)},
                    1);
}

PaperPlane PaperPlaneOf(const torch::Tensor& tensor) {
  const torch::Tensor levels =
      ((tensor + 1) * 127.5).round().clamp(0, 255).to(torch::kUInt8).contiguous();
  SAND_CHECK(levels.numel() == kPaperCount, levels.numel());
  return {levels.data_ptr<uint8_t>(), levels.data_ptr<uint8_t>() + kPaperCount};
}

}  // namespace sandwright
