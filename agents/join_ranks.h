// Finds the other ranks of a run.
#pragma once

#include <memory>

#include "agents/collective.h"

namespace sandwright {

// The processes that mpirun or srun started together with this one; Alone() where there are none.
// `lost_after_s` as JoinMpi takes it, and errors as there; Error also where the program was built
// without MPI.
std::shared_ptr<Collective> JoinRanks(double lost_after_s);

}  // namespace sandwright
