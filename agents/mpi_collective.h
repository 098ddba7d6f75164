// The ranks of a run as processes that mpirun or srun started. Only where the build found MPI.
#pragma once

#include <memory>

#include "agents/collective.h"

namespace sandwright {

// All of the `launched` processes call it once. A rank that does not answer for `lost_after_s` is lost:
// the others' calls throw Error. Throws Error where MPI knows of another number of processes.
std::shared_ptr<Collective> JoinMpi(int launched, double lost_after_s);

}  // namespace sandwright
