#include "data/base/stop.h"

#include <csignal>

#include "data/base/error.h"

namespace sandwright {
namespace {

// The one mutable global: a signal handler can reach nothing else.
volatile std::sig_atomic_t stop_requested = 0;

extern "C" void OnStopSignal(int signal) {
  if (stop_requested) std::signal(signal, SIG_DFL), std::raise(signal);
  stop_requested = 1;
}

}  // namespace

void InstallStopHandler() {
  std::signal(SIGINT, OnStopSignal);
  std::signal(SIGTERM, OnStopSignal);
}

bool StopRequested() { return stop_requested != 0; }

void ThrowIfStopRequested() {
  if (StopRequested()) throw Error("stopped by the user", ErrorKind::kInterrupted);
}

}  // namespace sandwright
