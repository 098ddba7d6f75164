#include "agents/join_ranks.h"

#include <spdlog/fmt/fmt.h>

#include <cstdlib>

#include "data/base/error.h"
#ifdef SANDWRIGHT_WITH_MPI
#include "agents/mpi_collective.h"
#endif

namespace sandwright {
namespace {

// How many processes the launcher says that it started. Asked before MPI is, which takes a moment and
// starts a helper process where there is no launcher.
int Launched() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"})
    if (const char* value = std::getenv(name)) return std::atoi(value);
  const char* tasks = std::getenv("SLURM_STEP_NUM_TASKS");
  return tasks && std::getenv("PMIX_RANK") ? std::atoi(tasks) : 1;
}

}  // namespace

std::shared_ptr<Collective> JoinRanks([[maybe_unused]] double lost_after_s) {
  const int launched = Launched();
  if (launched <= 1) return {&Alone(), [](Collective*) {}};
#ifdef SANDWRIGHT_WITH_MPI
  return JoinMpi(launched, lost_after_s);
#else
  throw Error(fmt::format("{} processes were started together, and this program was built without MPI: "
                          "install libopenmpi-dev and build anew, or start one", launched));
#endif
}

}  // namespace sandwright
