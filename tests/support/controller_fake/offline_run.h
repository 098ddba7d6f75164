// Runs a script on the controller without sockets, as fast as the machine can.
#pragma once

#include <string>

#include "tests/support/controller_fake/controller_core.h"

namespace sandwright::fake {

// Until the program has ended and the arm is at rest, or for `most_s` of the controller's time.
// Returns whether it ended.
inline bool RunToEnd(ControllerCore& core, const std::string& script, double most_s = 600) {
  core.Upload(script);
  const double end_s = core.state().time_s + most_s;
  while (core.state().runtime != RuntimeState::kStopped && core.state().time_s < end_s)
    core.Tick();
  return core.state().runtime == RuntimeState::kStopped;
}

}  // namespace sandwright::fake
