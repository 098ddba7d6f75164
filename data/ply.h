// PLY, the Stanford polygon format: points with faces, or points alone.
#pragma once

#include <string>
#include <string_view>

#include "data/mesh.h"

namespace sandwright {

// ASCII or binary of either byte order. Of `vertex` x, y and z count, of `face` its list of indices; other
// properties and elements are skipped. Error naming `source` and the fault.
Mesh ParsePly(std::string_view bytes, const std::string& source);

// Binary, little-endian, float32.
std::string FormatPly(const Mesh& mesh);

}  // namespace sandwright
