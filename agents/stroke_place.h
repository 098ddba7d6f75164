// Where a stroke starts and where it heads: start_x, start_y and heading (the first three numbers of
// the action, each on [-1, 1]) fall into one of headings x rows x columns bins with probability
// softmax(logits), and lie within the bin as `offset` says. Unlike one Beta a number, this can prefer
// two mounds to the hollow between them, and a heading may pass pi.
#pragma once

#include <torch/torch.h>

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
  // Where each place [B, 3] lies within its bin [B], each number on (-1, 1): [B, 3].
  torch::Tensor Offset(const torch::Tensor& place, const torch::Tensor& bin) const;
  // The place at `offset` [B, 3] within `bin` [B], its inverse: [B, 3]. Offsets are kept 0.001 off the
  // edges, so that rounding to float cannot leave the bin.
  torch::Tensor Place(const torch::Tensor& bin, const torch::Tensor& offset) const;
  // What the log density of an offset gains where it becomes that of a place.
  double LogDensityOfOffset() const;

 private:
  torch::Tensor HalfExtent() const;  // of a bin: [3]
};

}  // namespace sandwright
