// Noise that is correlated in time, for exploration: steps of one sign in a row reach what steps
// that cancel out do not (Eberhard, Hollenstein, Pinneri, Martius, "Pink noise is all you need",
// ICLR 2023).
#pragma once

#include <vector>

#include "data/base/random.h"

namespace sandwright {

// `count` numbers, each of the standard normal distribution, whose power falls with frequency f as
// f^-color: 0 white, 1 pink, 2 red (Timmer and Koenig, Astronomy and Astrophysics 300, 1995).
std::vector<float> ColoredNoise(int64_t count, double color, RandomStream& stream);

}  // namespace sandwright
