// What a model file says of the strokes that it was made from.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "env/safetensors.h"

namespace sandwright {

// The metadata `data`: see SplitIdentity. An empty object where the file says nothing; Error naming
// `source` where it is no JSON object.
nlohmann::json DataOf(const Safetensors& model, const std::string& source);

struct ModelOrigin {
  std::optional<int> strokes;  // trained on; none: the file does not say
  // All that it has seen: trained on, chosen by, and the same of the models that it started from.
  std::set<std::string> beds, files_sha256;
};

ModelOrigin OriginOf(const Safetensors& model, const std::string& source);

// One reason for each of the stroke files that cannot judge the model because it has seen them, or
// others of the same bed.
std::vector<std::string> SeenBefore(const ModelOrigin& origin,
                                    std::span<const std::filesystem::path> files);

}  // namespace sandwright
