// A sand model by the name or file that a user gives, those with it that need torch.
#pragma once

#include "env/sand_model_by_name.h"

namespace sandwright {

// What SandModelByName takes, and the .safetensors file of a pix2pix.
std::unique_ptr<SandModel> LoadSandModel(const std::string& name_or_file,
                                         const SandModelConfig& config);

}  // namespace sandwright
