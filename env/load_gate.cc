#include "env/load_gate.h"

#include <filesystem>

#include "data/shipped.h"

namespace sandwright {

std::unique_ptr<const SafetyGate> LoadGate(const std::string& workcell_file) {
  if (workcell_file.empty()) return nullptr;
  const std::filesystem::path file = workcell_file;
  const bool shipped = !file.has_parent_path() && !std::filesystem::exists(file);
  return std::make_unique<const SafetyGate>(
      LoadWorkcell(shipped ? ShippedConfig(workcell_file) : file));
}

}  // namespace sandwright
