#include "agents/stroke_place.h"

#include <algorithm>
#include <cmath>

#include "agents/categorical.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

// Which of `count` equal parts of [-1, 1] each value lies in.
torch::Tensor PartOf(const torch::Tensor& value, int count) {
  return ((value + 1.0) * (0.5 * count)).floor().clamp(0, count - 1).to(torch::kInt64);
}

torch::Tensor MiddleOf(const torch::Tensor& part, int count) {
  return (part.to(torch::kFloat32) + 0.5) * (2.0 / count) - 1.0;
}

}  // namespace

double PlaceGrid::LogVolume() const { return std::log(8.0 / bins()); }

torch::Tensor PlaceGrid::Bin(const torch::Tensor& place) const {
  const auto column = PartOf(place.select(-1, 0), columns);
  const auto row = PartOf(place.select(-1, 1), rows);
  const auto heading = PartOf(place.select(-1, 2), headings);
  return (heading * rows + row) * columns + column;
}

torch::Tensor PlaceGrid::Centre(const torch::Tensor& bin) const {
  const auto column = bin.remainder(columns);
  const auto row = torch::floor_divide(bin, columns).remainder(rows);
  const auto heading = torch::floor_divide(bin, cells());
  return torch::stack({MiddleOf(column, columns), MiddleOf(row, rows), MiddleOf(heading, headings)},
                      -1);
}

torch::Tensor PlaceGrid::LogProb(const torch::Tensor& logits, const torch::Tensor& bin) const {
  return CategoricalLogProb(logits, bin) - LogVolume();
}

torch::Tensor PlaceGrid::Entropy(const torch::Tensor& logits) const {
  return LogVolume() + CategoricalEntropy(logits);
}

std::array<float, PlaceGrid::kNumbers> PlaceGrid::Sample(std::span<const float> probability,
                                                         RandomStream& stream) const {
  SAND_CHECK(static_cast<int>(probability.size()) == bins(), probability.size(), bins());
  const int bin = SampleCategorical(probability, stream);
  // A little off the edges, so that rounding to float cannot leave the bin.
  auto within = [&](int part, int count) {
    return static_cast<float>((part + stream.Uniform(0.001, 0.999)) * 2.0 / count - 1.0);
  };
  const float x = within(bin % columns, columns);
  const float y = within(bin / columns % rows, rows);
  return {x, y, within(bin / cells(), headings)};
}

}  // namespace sandwright
