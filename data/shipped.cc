#include "data/shipped.h"

#include <dlfcn.h>

#include <cstdlib>
#include <vector>

#include "data/base/error.h"

namespace sandwright {

std::filesystem::path ShippedFile(const std::string& relative) {
  std::vector<std::filesystem::path> folders;
  if (const char* named = std::getenv("SANDWRIGHT_DATA"); named && *named) {
    folders = {named};
  } else {
    folders = {SANDWRIGHT_DATA_FOLDER};
    std::error_code unknown;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", unknown);
    if (!unknown) folders.push_back(program.parent_path() / "data");
    // Of the Python module, where this code is part of it.
    if (Dl_info module; dladdr(reinterpret_cast<const void*>(&ShippedFile), &module) != 0)
      folders.push_back(std::filesystem::path(module.dli_fname).parent_path() / "data");
  }
  std::string places;
  for (const auto& folder : folders) {
    if (std::filesystem::exists(folder / relative)) return folder / relative;
    places += "\n  " + (folder / relative).string();
  }
  throw Error("a file that ships with the program is missing; looked for" + places +
              "\nSet SANDWRIGHT_DATA to the folder that holds it");
}

}  // namespace sandwright
