// The heightfield on larger cells than the map's: a cheap first guess for what corrects it.
#pragma once

#include "env/heightfield.h"

namespace sandwright {

// Like Heightfield::Apply, but on cells `factor` times as large as the map's: those are means of the
// map's cells (of fewer along a wall, where they do not come out even), and the change of the large
// cells, interpolated, is added to the small ones. Volume is kept and the floor holds, as AddResidual
// has it; what the terrain holds of detail stays. factor = 1 is the heightfield itself.
Outcome ApplyOnCoarseCells(const Heightfield& heightfield, int factor, SandState& state,
                           const ToolPath& path);

}  // namespace sandwright
