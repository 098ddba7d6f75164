#include "agents/symmetry.h"

namespace sandwright {
namespace {

constexpr int kMirrorX = 1, kMirrorY = 2, kSwap = 4;

// Headings in half turns, brought to [-1, 1).
torch::Tensor Wrapped(const torch::Tensor& heading) {
  return heading - 2.0 * ((heading + 1.0) / 2.0).floor();
}

}  // namespace

int SymmetriesOf(const ObservationSpec& spec, const Region& region) {
  return spec.rows == spec.columns && region.width_m == region.depth_m ? kSymmetriesOfSquare
                                                                       : kSymmetriesOfRectangle;
}

torch::Tensor Transformed(const torch::Tensor& map, int symmetry) {
  auto out = symmetry & kSwap ? map.transpose(2, 3) : map;
  if (symmetry & kMirrorX) out = out.flip(3);
  if (symmetry & kMirrorY) out = out.flip(2);
  return out;
}

torch::Tensor TransformedAction(const torch::Tensor& action, int symmetry) {
  auto x = action.select(1, 0), y = action.select(1, 1), heading = action.select(1, 2),
       bend = action.select(1, 6);
  if (symmetry & kSwap) {
    std::swap(x, y);
    heading = 0.5 - heading;
    bend = -bend;
  }
  if (symmetry & kMirrorX) {
    x = -x;
    heading = 1.0 - heading;
    bend = -bend;
  }
  if (symmetry & kMirrorY) {
    y = -y;
    heading = -heading;
    bend = -bend;
  }
  return torch::cat({torch::stack({x, y, Wrapped(heading)}, 1), action.narrow(1, 3, 3),
                     bend.unsqueeze(1)},
                    1);
}

}  // namespace sandwright
