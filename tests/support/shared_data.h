// Data that tests read from outside the repository and that the project may not ship.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace sandwright {

// `name` below the folder that SANDWRIGHT_SHARED names, or below ../shared beside the repository;
// a test whose file is not there skips itself.
inline std::filesystem::path SharedFile(const std::string& name) {
  const char* folder = std::getenv("SANDWRIGHT_SHARED");
  const std::filesystem::path root =
      folder != nullptr ? folder : std::filesystem::path(SANDWRIGHT_ROOT).parent_path() / "shared";
  return root / name;
}

}  // namespace sandwright
