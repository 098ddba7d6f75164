// A sand model by the name or file that a user gives.
#pragma once

#include <memory>
#include <string>

#include "env/heightfield.h"

namespace sandwright {

// `heightfield` (with `config`), `none` (nothing changes; `config`'s blade), `default` (the shipped
// surrogate) or a .safetensors file that `fit` wrote. A surrogate brings its own heightfield and
// blade and takes only the threads of `config`. Throws Error for any other name: `dem` stands for
// grains, which this version does not run.
std::unique_ptr<SandModel> LoadSandModel(const std::string& name_or_file,
                                         const HeightfieldConfig& config);

}  // namespace sandwright
