// numpy.random.Generator.standard_normal, bit for bit.
#pragma once

#include "env/reference/numpy_random.h"

namespace sandwright {

// One draw from N(0, 1).
double StandardNormal(NumpyRandom& random);

}  // namespace sandwright
