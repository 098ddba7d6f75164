// Brings the numbers of an observation to mean 0 and variance 1, as seen so far.
#pragma once

#include <torch/torch.h>

#include <span>

namespace sandwright {

// The statistics are buffers of the module: saved with the weights, and moved by Observe alone, so
// that a policy in use keeps those of its training.
class ObservationNormalizer : public torch::nn::Module {
 public:
  explicit ObservationNormalizer(int64_t size);

  // Takes in rows [B, size]: mean and variance of all rows ever (Chan, Golub, LeVeque, "Updating
  // formulae and a pairwise algorithm for computing sample variances", 1982).
  void Observe(const torch::Tensor& rows);
  // [B, size], within +-10 standard deviations. Before anything was observed: as it is.
  torch::Tensor Forward(const torch::Tensor& rows) const;
  // The same in place and on the CPU, without torch's overhead: one row [size].
  void ForwardRow(std::span<float> row) const;

 private:
  torch::Tensor count_, mean_, variance_;  // [1], [size], [size]
};

}  // namespace sandwright
