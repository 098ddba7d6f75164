// A few rows through a small perceptron without torch, whose every operation costs microseconds
// before it computes: with it, rollouts of one HalfCheetah took 3.5 times as long.
#pragma once

#include <torch/torch.h>

#include <Eigen/Core>

namespace sandwright {

using PlainRows = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// tanh(hidden(tanh(in(rows)))) of layers on the CPU: [B, inputs] to [B, hidden].
PlainRows PlainTanhLayers(const torch::nn::Linear& in, const torch::nn::Linear& hidden,
                          const PlainRows& rows);
// [B, inputs] to [B, outputs].
PlainRows PlainLinear(const torch::nn::Linear& layer, const PlainRows& rows);

}  // namespace sandwright
