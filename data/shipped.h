// The files that come with the program: models and samples below data/.
#pragma once

#include <filesystem>
#include <string>

namespace sandwright {

// `relative` ("models/default_surrogate.safetensors") in the folder that the environment variable
// SANDWRIGHT_DATA names; without it in the source tree's data/, then in `data` beside the program.
// Throws Error naming the places where it was looked for.
std::filesystem::path ShippedFile(const std::string& relative);
// A configuration of configs/, which lies beside data/.
inline std::filesystem::path ShippedConfig(const std::string& name) {
  return ShippedFile("../configs/" + name);
}

}  // namespace sandwright
