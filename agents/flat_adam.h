// Adam (Kingma and Ba, ICLR 2015) over one flat buffer: the parameters of a network become views
// into it, and so do their gradients. One norm, one update and one tensor to save or to sum over
// machines instead of a hundred small ones.
#pragma once

#include <torch/torch.h>

#include <span>
#include <string>
#include <vector>

#include "agents/collective.h"
#include "env/safetensors.h"

namespace sandwright {

class FlatAdam {
 public:
  // Moves the storage of `parameters` into the flat buffer; the network keeps working on it.
  FlatAdam(const std::vector<torch::Tensor>& parameters, double epsilon);

  void ZeroGradients() { gradient_.zero_(); }
  // The gradient and `riders`, which save a message of their own, become their sums over all ranks.
  void SumGradients(Collective& ranks, std::span<float> riders);
  // Scales the gradient so that its 2-norm is at most `limit`; returns the norm before.
  double ClipGradients(double limit);
  void Step(double learning_rate);
  // All of these down `loss`. Throws Error where its gradient is not finite.
  void Descend(const torch::Tensor& loss, double learning_rate, double gradient_limit);

  // All of the state beside parameters and learning rate, under `name`. Load throws Error naming
  // `source` where the moments belong to other parameters.
  void Save(const std::string& name, Safetensors& content) const;
  void Load(const std::string& name, const Safetensors& content, const std::string& source);

 private:
  double epsilon_;
  int64_t steps_ = 0;
  std::vector<torch::Tensor> parameters_;
  std::vector<float> message_;
  torch::Tensor values_, gradient_, first_moment_, second_moment_;  // [P]
};

}  // namespace sandwright
