#include "env/load_sand_model.h"

#include "data/shipped.h"
#include "env/dem.h"
#include "env/pix2pix.h"
#include "env/surrogate.h"

namespace sandwright {
namespace {

// By what the file says it is.
std::unique_ptr<SandModel> ReadModel(const std::filesystem::path& file, int64_t threads) {
  const std::string source = file.string();
  const Safetensors content = ReadSafetensors(file);
  const auto schema = content.metadata.find("schema");
  const std::string kind = schema == content.metadata.end() ? "" : schema->second;
  if (kind == "sandwright-surrogate")
    return std::make_unique<Surrogate>(ReadSurrogate(content, source, threads));
  if (kind == "sandwright-pix2pix") return ReadPix2Pix(content, source, threads);
  throw Error(source + ": not a sand model (metadata schema is \"" + kind +
              "\"; expected sandwright-surrogate or sandwright-pix2pix)");
}

}  // namespace

std::unique_ptr<SandModel> LoadSandModel(const std::string& name_or_file,
                                         const SandModelConfig& config) {
  if (name_or_file == "heightfield") return std::make_unique<Heightfield>(config.heightfield);
  if (name_or_file == "none") return std::make_unique<StillSand>(config.heightfield.blade);
  if (name_or_file == "dem") return std::make_unique<Dem>(config.dem);
  if (name_or_file == "default")
    return ReadModel(ShippedFile("models/default_surrogate.safetensors"),
                     config.heightfield.threads);
  if (name_or_file.ends_with(".safetensors"))
    return ReadModel(name_or_file, config.heightfield.threads);
  throw Error("unknown sand model '" + name_or_file +
              "'; allowed: heightfield, dem, none, default, or a .safetensors file from fit");
}

}  // namespace sandwright
