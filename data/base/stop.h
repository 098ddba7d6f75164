// Ctrl-C as a flag that long loops poll: what is done is kept.
#pragma once

namespace sandwright {

// SIGINT and SIGTERM set the flag; a second one ends the program at once.
void InstallStopHandler();
bool StopRequested();
// Throws Error (kInterrupted, exit 130) when a stop was requested.
void ThrowIfStopRequested();

}  // namespace sandwright
