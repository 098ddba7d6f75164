// The symmetries of a rectangle of sand: a mirrored bed under a mirrored stroke ends mirrored, so one
// example is worth four, on a square eight (the dihedral group; the augmentation of Silver et al.,
// "Mastering the game of Go without human knowledge", Nature 2017). The arm and the walls' gate are
// not symmetric; what they refuse is only nearly so.
#pragma once

#include <torch/torch.h>

#include "env/action.h"
#include "env/vec_env.h"

namespace sandwright {

// Element 0..7 of the group, 0: nothing. Bit 2 swaps x and y (squares only), done first; bit 0 then
// turns x to -x, bit 1 y to -y.
inline constexpr int kSymmetriesOfRectangle = 4, kSymmetriesOfSquare = 8;

// How many there are of a region seen as `spec` shows it.
int SymmetriesOf(const ObservationSpec& spec, const Region& region);

// Observation maps [B, C, rows (y), columns (x)].
torch::Tensor Transformed(const torch::Tensor& map, int symmetry);
// Actions of env/action.h [B, 7].
torch::Tensor TransformedAction(const torch::Tensor& action, int symmetry);

}  // namespace sandwright
