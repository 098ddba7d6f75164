// A sand model by the name or file that a user gives.
#pragma once

#include <memory>
#include <string>

#include "env/dem_config.h"
#include "env/heightfield.h"

namespace sandwright {

struct SandModelConfig {
  HeightfieldConfig heightfield;
  DemConfig dem;

  void Fields(FieldList& f) {
    f.Section("heightfield", heightfield);
    f.Section("dem", dem);
  }
};

// `heightfield`, `none` (nothing changes; the heightfield's blade), `default` (the shipped
// surrogate), `dem` (grains; needs LAMMPS when it runs) or a .safetensors file that `fit` wrote (a
// surrogate or pix2pix, as its metadata says). Such a file brings its own heightfield and blade and
// takes only the threads of `config.heightfield`.
// Throws Error for any other name.
std::unique_ptr<SandModel> LoadSandModel(const std::string& name_or_file,
                                         const SandModelConfig& config);

}  // namespace sandwright
