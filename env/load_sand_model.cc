#include "env/load_sand_model.h"

#include "env/pix2pix.h"
#include "env/surrogate.h"

namespace sandwright {

std::unique_ptr<SandModel> LoadSandModel(const std::string& name_or_file,
                                         const SandModelConfig& config) {
  if (!name_or_file.ends_with(".safetensors")) return SandModelByName(name_or_file, config);
  const Safetensors content = ReadSafetensors(name_or_file);
  const auto schema = content.metadata.find("schema");
  if (schema != content.metadata.end() && schema->second == "sandwright-pix2pix")
    return ReadPix2Pix(content, name_or_file, config.heightfield.threads);
  return std::make_unique<Surrogate>(
      ReadSurrogate(content, name_or_file, config.heightfield.threads));
}

}  // namespace sandwright
