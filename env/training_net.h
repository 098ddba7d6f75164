// The surrogate's net with gradients, in torch: the same layers as surrogate_net.h.
#pragma once

#include <torch/types.h>

#include <string>
#include <vector>

#include "data/base/random.h"
#include "env/fit_samples.h"
#include "env/surrogate_net.h"

namespace sandwright {

// Samples side by side, padded with zeros to the largest.
struct FitBatch {
  FitBatch(const SurrogateNetConfig& config, const std::vector<FitSample>& samples);
  torch::Tensor inputs;          // [N, config.inputs(), H, W]
  torch::Tensor active, inside;  // [N, 1, H, W] of zeros and ones
  torch::Tensor target, weight;  // [N, H, W]
};

class TrainingNet {
 public:
  // He's initialisation; the head starts at zero, so that the net starts from changing nothing.
  TrainingNet(const SurrogateNetConfig& config, RandomStream stream);

  const SurrogateNetConfig& config() const { return config_; }
  const std::vector<torch::Tensor>& parameters() const { return parameters_; }
  // The change that the net says [N, H, W] in units of kResidualScale_m. Of surrogate_paste.h only
  // what is linear is done: neither the floor nor the volume limits it here.
  torch::Tensor Forward(const FitBatch& batch) const;

  // Tensors `prefix` + layer + ".weight" and ".bias". Load: Error naming `source` where one is
  // missing or has another shape.
  void Save(Safetensors& file, const std::string& prefix = "") const;
  void Load(const Safetensors& file, const std::string& source, const std::string& prefix = "");

 private:
  SurrogateNetConfig config_;
  std::vector<ConvShape> shapes_;
  std::vector<torch::Tensor> parameters_;  // weight, bias of each layer
};

// A tensor as it is kept on disk.
NamedTensor ToNamed(const torch::Tensor& tensor);

}  // namespace sandwright
