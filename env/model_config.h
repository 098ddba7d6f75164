// The configuration that a learned model's file carries.
#pragma once

#include <string>

#include "data/base/config.h"
#include "env/safetensors.h"

namespace sandwright {

// Reads metadata "config", JSON text, into `fields`. Error naming `source` where it is missing, no
// JSON, or does not fit the fields.
void LoadModelConfig(const Safetensors& content, const std::string& source,
                     const FieldList& fields);

}  // namespace sandwright
