#include "env/load_sand_model.h"

#include "data/shipped.h"
#include "env/dem.h"
#include "env/surrogate.h"

namespace sandwright {

std::unique_ptr<SandModel> LoadSandModel(const std::string& name_or_file,
                                         const SandModelConfig& config) {
  const auto surrogate = [&](const std::filesystem::path& file) {
    return std::make_unique<Surrogate>(ReadSurrogate(file, config.heightfield.threads));
  };
  if (name_or_file == "heightfield") return std::make_unique<Heightfield>(config.heightfield);
  if (name_or_file == "none") return std::make_unique<StillSand>(config.heightfield.blade);
  if (name_or_file == "dem") return std::make_unique<Dem>(config.dem);
  if (name_or_file == "default")
    return surrogate(ShippedFile("models/default_surrogate.safetensors"));
  if (name_or_file.ends_with(".safetensors")) return surrogate(name_or_file);
  throw Error("unknown sand model '" + name_or_file +
              "'; allowed: heightfield, dem, none, default, or a .safetensors file from fit");
}

}  // namespace sandwright
