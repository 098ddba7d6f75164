#include "env/sand_model_by_name.h"

#include "data/shipped.h"
#include "env/dem.h"
#include "env/surrogate.h"

namespace sandwright {

std::unique_ptr<SandModel> SandModelByName(const std::string& name_or_file,
                                           const SandModelConfig& config) {
  if (name_or_file == "heightfield") return std::make_unique<Heightfield>(config.heightfield);
  if (name_or_file == "none") return std::make_unique<StillSand>(config.heightfield.blade);
  if (name_or_file == "dem") return std::make_unique<Dem>(config.dem);
  if (name_or_file == "default" || name_or_file == "fast")
    return std::make_unique<Surrogate>(
        ReadSurrogate(ShippedFile("models/" + name_or_file + "_surrogate.safetensors"),
                      config.heightfield.threads));
  if (name_or_file.ends_with(".safetensors"))
    return std::make_unique<Surrogate>(ReadSurrogate(name_or_file, config.heightfield.threads));
  throw Error("unknown sand model '" + name_or_file +
              "'; allowed: heightfield, dem, none, default, fast, or a .safetensors file from fit");
}

}  // namespace sandwright
