// Where a stroke starts and where it heads, as one density over a grid: start_x, start_y and
// heading (the first three numbers of the action, each on [-1, 1]) fall into one of headings x rows
// x columns bins with probability softmax(logits), evenly within the bin. Unlike one Beta a number,
// this can prefer two mounds to the hollow between them, and a heading may pass pi.
#pragma once

#include <torch/torch.h>

#include <array>
#include <span>

#include "data/base/random.h"

namespace sandwright {

struct PlaceGrid {
  static constexpr int kNumbers = 3;  // of the action that it covers

  int headings = 1, rows = 1, columns = 1;
  int bins() const { return headings * rows * columns; }
  int cells() const { return rows * columns; }

  // The bin of each place [B, 3]: int64 [B], (heading * rows + row) * columns + column.
  torch::Tensor Bin(const torch::Tensor& place) const;
  // The middle of each bin [B]: [B, 3].
  torch::Tensor Centre(const torch::Tensor& bin) const;
  // Log density of `bin` [B] under `logits` [B, bins()]: [B].
  torch::Tensor LogProb(const torch::Tensor& logits, const torch::Tensor& bin) const;
  // Differential entropy: [B].
  torch::Tensor Entropy(const torch::Tensor& logits) const;
  // One draw; `probability` has bins() entries that sum to 1.
  std::array<float, kNumbers> Sample(std::span<const float> probability,
                                     RandomStream& stream) const;

 private:
  double LogVolume() const;  // of one bin
};

}  // namespace sandwright
