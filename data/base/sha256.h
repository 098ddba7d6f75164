// SHA-256, the identity of contents: cells, terrains, plans, models.
#pragma once

#include <string>
#include <string_view>

namespace sandwright {

// 64 hexadecimal digits.
std::string Sha256Hex(std::string_view bytes);

}  // namespace sandwright
