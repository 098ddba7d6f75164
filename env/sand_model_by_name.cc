#include "env/sand_model_by_name.h"

#include <spdlog/fmt/fmt.h>

#include <sstream>

#include "data/shipped.h"
#include "env/dem.h"
#include "env/surrogate.h"

namespace sandwright {
namespace {

std::unique_ptr<SandModel> MixtureOf(const std::string& names, const SandModelConfig& config) {
  std::vector<std::unique_ptr<SandModel>> models;
  std::stringstream list(names);
  for (std::string name; std::getline(list, name, ',');)
    models.push_back(SandModelByName(name, config));
  return std::make_unique<MixedSand>(std::move(models));
}

}  // namespace

std::optional<std::filesystem::path> ModelFileOf(const std::string& name_or_file) {
  if (name_or_file == "default" || name_or_file == "fast")
    return ShippedFile("models/" + name_or_file + "_surrogate.safetensors");
  if (name_or_file.ends_with(".safetensors")) return name_or_file;
  return std::nullopt;
}

std::unique_ptr<SandModel> SandModelByName(const std::string& name_or_file,
                                           const SandModelConfig& config) {
  if (name_or_file.find(',') != std::string::npos) return MixtureOf(name_or_file, config);
  if (config.random.variants > 0) {
    if (name_or_file != "heightfield")
      throw Error(fmt::format(
          "random.variants = {} with the sand model '{}'; only the heightfield has variants. "
          "Several surrogates: their files, separated by commas",
          config.random.variants, name_or_file));
    return std::make_unique<MixedSand>(RandomSand(config.heightfield, config.random));
  }
  if (name_or_file == "heightfield") return std::make_unique<Heightfield>(config.heightfield);
  if (name_or_file == "none") return std::make_unique<StillSand>(config.heightfield.blade);
  if (name_or_file == "dem") return std::make_unique<Dem>(config.dem);
  if (const auto file = ModelFileOf(name_or_file))
    return std::make_unique<Surrogate>(ReadSurrogate(*file, config.heightfield.threads));
  throw Error("unknown sand model '" + name_or_file +
              "'; allowed: heightfield, dem, none, default, fast, or a .safetensors file from fit");
}

}  // namespace sandwright
