#include "env/model_config.h"

#include "data/base/error.h"

namespace sandwright {

void LoadModelConfig(const Safetensors& content, const std::string& source,
                     const FieldList& fields) {
  nlohmann::json json;
  try {
    json = nlohmann::json::parse(content.Metadata("config", source));
  } catch (const nlohmann::json::exception& e) {
    throw Error(source + ": metadata config is not JSON: " + e.what());
  }
  LoadJson(fields, json, source + ": config");
}

}  // namespace sandwright
