// The page of a run that looks at itself: a browser may stand open beside it for days.
#pragma once

#include <string>

#include "data/base/run_status.h"

namespace sandwright {

// Self-contained and self-refreshing. It shows how old it is, and says so where a run that has not
// ended has been silent for longer than it ever was: it was killed, or hangs.
std::string RenderLivePage(const RunReport& report);

}  // namespace sandwright
