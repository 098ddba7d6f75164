#include "env/load_sand_model.h"

#include "data/shipped.h"
#include "env/surrogate.h"

namespace sandwright {

std::unique_ptr<SandModel> LoadSandModel(const std::string& name_or_file,
                                         const HeightfieldConfig& config) {
  const auto surrogate = [&](const std::filesystem::path& file) {
    return std::make_unique<Surrogate>(ReadSurrogate(file, config.threads));
  };
  if (name_or_file == "heightfield") return std::make_unique<Heightfield>(config);
  if (name_or_file == "none") return std::make_unique<StillSand>(config.blade);
  if (name_or_file == "default")
    return surrogate(ShippedFile("models/default_surrogate.safetensors"));
  if (name_or_file.ends_with(".safetensors")) return surrogate(name_or_file);
  const std::string allowed =
      "allowed: heightfield, none, default, or a .safetensors file from fit";
  if (name_or_file == "dem")
    throw Error(
        "sand model 'dem' (grains) does not run in this version; recorded grain strokes are under "
        "data/strokes/dem; " +
        allowed);
  throw Error("unknown sand model '" + name_or_file + "'; " + allowed);
}

}  // namespace sandwright
