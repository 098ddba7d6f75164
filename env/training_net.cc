#include "env/training_net.h"

#include <algorithm>
#include <cmath>

namespace sandwright {
namespace {

// The change that fluxes make: [N, 2, H, W] of surrogate_paste.h -> [N, H, W]. Faces are open where
// both cells count in `inside` [N, 1, H, W]. The floor does not limit them here.
torch::Tensor Divergence(const torch::Tensor& flux, const torch::Tensor& inside) {
  const auto along = [&](int64_t output, int64_t dimension) {
    const int64_t faces = flux.size(dimension) - 1;
    const torch::Tensor open =
        (inside.narrow(dimension, 0, faces) * inside.narrow(dimension, 1, faces)).squeeze(1);
    const torch::Tensor through = flux.select(1, output).narrow(dimension - 1, 0, faces) * open;
    const torch::Tensor closed = torch::zeros_like(through.narrow(dimension - 1, 0, 1));
    return torch::cat({closed, through}, dimension - 1) -
           torch::cat({through, closed}, dimension - 1);
  };
  return along(0, 3) + along(1, 2);
}

}  // namespace

FitBatch::FitBatch(const SurrogateNetConfig& config, const std::vector<FitSample>& samples) {
  int rows = 0, columns = 0;
  for (const FitSample& s : samples)
    rows = std::max(rows, s.input.rows), columns = std::max(columns, s.input.columns);
  const auto count = static_cast<int64_t>(samples.size());
  const auto zeros = [&](int64_t channels) {
    return torch::zeros({count, channels, rows, columns});
  };
  inputs = zeros(config.inputs());
  active = zeros(1);
  inside = zeros(1);
  target = zeros(1).squeeze(1);
  weight = zeros(1).squeeze(1);
  const auto place = [](const std::vector<float>& values, torch::Tensor to, const FitSample& s) {
    const auto from =
        torch::from_blob(const_cast<float*>(values.data()),
                         {static_cast<int64_t>(values.size()) / (s.input.rows * s.input.columns),
                          s.input.rows, s.input.columns});
    to.view({-1, to.size(-2), to.size(-1)})
        .narrow(1, 0, s.input.rows)
        .narrow(2, 0, s.input.columns)
        .copy_(from);
  };
  for (size_t i = 0; i < samples.size(); ++i) {
    const auto n = static_cast<int64_t>(i);
    const SurrogateInput& input = samples[i].input;
    const size_t cells = input.active.size();
    place(config.linear() ? LinearFeatures(input.channels, cells) : input.channels, inputs[n],
          samples[i]);
    place({input.active.begin(), input.active.end()}, active[n], samples[i]);
    place({input.channels.begin(), input.channels.begin() + static_cast<ptrdiff_t>(cells)},
          inside[n], samples[i]);  // the first channel
    place(samples[i].target, target[n], samples[i]);
    place(samples[i].weight, weight[n], samples[i]);
  }
}

TrainingNet::TrainingNet(const SurrogateNetConfig& config, RandomStream stream)
    : config_(config), shapes_(SurrogateLayers(config)) {
  for (const ConvShape& shape : shapes_) {
    auto weight = torch::zeros({shape.out, shape.in, shape.size, shape.size});
    const double deviation =
        shape.name == "head" ? 0 : std::sqrt(2.0 / (shape.in * shape.size * shape.size));
    float* values = weight.data_ptr<float>();
    for (int64_t i = 0; i < weight.numel(); ++i)
      values[i] = static_cast<float>(deviation * stream.Normal());
    parameters_.push_back(weight.set_requires_grad(true));
    parameters_.push_back(torch::zeros({shape.out}).set_requires_grad(true));
  }
}

torch::Tensor TrainingNet::Forward(const FitBatch& batch) const {
  size_t next = 0;
  const auto convolve = [&](const torch::Tensor& x) {
    const size_t at = 2 * next++;
    return torch::conv2d(x, parameters_[at], parameters_[at + 1], 1,
                         (shapes_[at / 2].size - 1) / 2);
  };
  const auto block = [&](torch::Tensor x, const torch::Tensor& mask) {
    x = torch::relu(convolve(x)) * mask;
    return torch::relu(convolve(x)) * mask;
  };
  std::vector<torch::Tensor> skips, masks{torch::max_pool2d(batch.active, config_.patch_cells)};
  torch::Tensor x = torch::pixel_unshuffle(batch.inputs, config_.patch_cells) * masks[0];
  if (!config_.linear()) {
    for (int level = 0; level < config_.poolings; ++level) {
      skips.push_back(block(x, masks.back()));
      masks.push_back(torch::max_pool2d(masks.back(), 2));
      x = torch::avg_pool2d(skips.back(), 2);
    }
    x = block(x, masks.back());
    for (auto level = static_cast<size_t>(config_.poolings); level-- > 0;) {
      x = x.repeat_interleave(2, 2).repeat_interleave(2, 3) * masks[level];
      x = block(torch::cat({skips[level], x}, 1), masks[level]);
    }
  }
  x = torch::pixel_shuffle(convolve(x), config_.patch_cells) * batch.active;
  return config_.architecture == "flux" ? Divergence(x, batch.inside * batch.active) : x.squeeze(1);
}

void TrainingNet::Save(Safetensors& file, const std::string& prefix) const {
  for (size_t i = 0; i < parameters_.size(); ++i)
    file.tensors[prefix + shapes_[i / 2].name + (i % 2 == 0 ? ".weight" : ".bias")] =
        ToNamed(parameters_[i]);
}

void TrainingNet::Load(const Safetensors& file, const std::string& source,
                       const std::string& prefix) {
  const torch::NoGradGuard no_grad;
  for (size_t i = 0; i < parameters_.size(); ++i) {
    const std::string name = prefix + shapes_[i / 2].name + (i % 2 == 0 ? ".weight" : ".bias");
    const NamedTensor& tensor = file.Tensor(name, source);
    if (tensor.shape != parameters_[i].sizes().vec())
      throw Error(source + ": tensor " + name + " has another shape than the configured net");
    std::ranges::copy(tensor.values, parameters_[i].data_ptr<float>());
  }
}

NamedTensor ToNamed(const torch::Tensor& tensor) {
  const torch::Tensor flat = tensor.detach().contiguous();
  return {flat.sizes().vec(), {flat.data_ptr<float>(), flat.data_ptr<float>() + flat.numel()}};
}

}  // namespace sandwright
