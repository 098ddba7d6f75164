// What a measured figure was measured with.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace sandwright {

// Program version and git commit ("-dirty" behind it where the tree had changes) at build time.
std::string BuildVersion();
std::string BuildCommit();

// {cpu, threads, isa}: the processor's name, its hardware threads, the widest vector sets it has.
nlohmann::json MachineDescription();

}  // namespace sandwright
