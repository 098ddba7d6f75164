// Numbers that may be missing, in results.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

namespace sandwright {

// null where there is none.
inline nlohmann::json JsonNumber(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

}  // namespace sandwright
