#include "agents/stroke_place.h"

#include <cmath>

namespace sandwright {
namespace {

constexpr double kLargestOffset = 0.999;

// Which of `count` equal parts of [-1, 1] each value lies in.
torch::Tensor PartOf(const torch::Tensor& value, int count) {
  return ((value + 1.0) * (0.5 * count)).floor().clamp(0, count - 1).to(torch::kInt64);
}

torch::Tensor MiddleOf(const torch::Tensor& part, int count) {
  return (part.to(torch::kFloat32) + 0.5) * (2.0 / count) - 1.0;
}

}  // namespace

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

torch::Tensor PlaceGrid::HalfExtent() const {
  return torch::tensor({1.0f / columns, 1.0f / rows, 1.0f / headings});
}

torch::Tensor PlaceGrid::Offset(const torch::Tensor& place, const torch::Tensor& bin) const {
  const auto offset = (place - Centre(bin)) / HalfExtent().to(place.device());
  return offset.clamp(-kLargestOffset, kLargestOffset);
}

torch::Tensor PlaceGrid::Place(const torch::Tensor& bin, const torch::Tensor& offset) const {
  return Centre(bin) +
         offset.clamp(-kLargestOffset, kLargestOffset) * HalfExtent().to(offset.device());
}

double PlaceGrid::LogDensityOfOffset() const { return std::log(static_cast<double>(bins())); }

}  // namespace sandwright
