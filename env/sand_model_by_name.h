// A sand model by the name or file that a user gives, of those that predict without torch.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "env/dem_config.h"
#include "env/mixed_sand.h"

namespace sandwright {

struct SandModelConfig {
  HeightfieldConfig heightfield;
  RandomSandConfig random;
  DemConfig dem;

  void Fields(FieldList& f) {
    f.Section("heightfield", heightfield);
    f.Section("random", random);
    f.Section("dem", dem);
  }
};

// `heightfield`, `none` (nothing changes; the heightfield's blade), `default` and `fast` (the
// shipped surrogates), `dem` (grains; needs LAMMPS when it runs) or the .safetensors file of a surrogate. Such
// a file brings its own heightfield and blade and takes only the threads of `config.heightfield`.
// Several of them, separated by commas, are one MixedSand; `heightfield` is one of its variants where
// `config.random` asks for them. Throws Error for any other name.
std::unique_ptr<SandModel> SandModelByName(const std::string& name_or_file,
                                           const SandModelConfig& config);

// The file of a surrogate by that name; none: the model has no file.
std::optional<std::filesystem::path> ModelFileOf(const std::string& name_or_file);

}  // namespace sandwright
