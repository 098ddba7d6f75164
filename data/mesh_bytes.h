// Numbers in the bytes of binary files.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace sandwright {

static_assert(std::endian::native == std::endian::little);

// The number of type T at the start of `bytes`, which must be long enough.
template <class T>
T NumberAt(std::string_view bytes, bool big_endian = false) {
  char raw[sizeof(T)];
  for (size_t i = 0; i < sizeof(T); ++i) raw[i] = bytes[big_endian ? sizeof(T) - 1 - i : i];
  T value;
  std::memcpy(&value, raw, sizeof(T));
  return value;
}

template <class T>
void Append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

}  // namespace sandwright
