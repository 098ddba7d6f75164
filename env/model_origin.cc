#include "env/model_origin.h"

#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/sha256.h"
#include "data/stroke_dataset.h"

namespace sandwright {
namespace {

void AddSeen(const nlohmann::json& data, ModelOrigin& origin) {
  for (const char* part : {"training", "validation"}) {
    if (!data.contains(part)) continue;
    for (const auto& bed : data[part].at("beds")) origin.beds.insert(bed.get<std::string>());
    for (const auto& [name, sha256] : data[part].at("files_sha256").items())
      origin.files_sha256.insert(sha256.get<std::string>());
  }
  if (data.contains("init")) AddSeen(data["init"], origin);
}

}  // namespace

nlohmann::json DataOf(const Safetensors& model, const std::string& source) {
  const auto found = model.metadata.find("data");
  if (found == model.metadata.end()) return nlohmann::json::object();
  auto json = nlohmann::json::parse(found->second, nullptr, false);
  if (!json.is_object()) throw Error(source + ": its metadata `data` is no JSON object");
  return json;
}

ModelOrigin OriginOf(const Safetensors& model, const std::string& source) {
  const nlohmann::json data = DataOf(model, source);
  ModelOrigin origin;
  try {
    AddSeen(data, origin);
    if (data.contains("training") && data["training"].contains("strokes"))
      origin.strokes = data["training"]["strokes"].get<int>();
  } catch (const nlohmann::json::exception& e) {
    throw Error(source + ": its metadata `data`: " + e.what());
  }
  return origin;
}

std::vector<std::string> SeenBefore(const ModelOrigin& origin,
                                    std::span<const std::filesystem::path> files) {
  std::vector<std::string> reasons;
  for (const auto& file : files) {
    if (origin.files_sha256.contains(Sha256Hex(ReadFile(file))))
      reasons.push_back(file.string() + ": the model was trained or chosen on this file");
    else if (const std::string bed = ReadStrokeFile(file).bed; origin.beds.contains(bed))
      reasons.push_back(file.string() + ": the model was trained or chosen on other strokes of its "
                                        "bed '" + bed + "'");
  }
  return reasons;
}

}  // namespace sandwright
