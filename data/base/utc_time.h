// The time of day as text.
#pragma once

#include <string>

namespace sandwright {

// ISO 8601 with milliseconds: "2024-05-01T12:00:00.000Z".
std::string UtcNow();

}  // namespace sandwright
