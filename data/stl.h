// STL: triangles one by one, without indices.
#pragma once

#include <string>
#include <string_view>

#include "data/mesh.h"

namespace sandwright {

// Binary or ASCII, told apart by the length that a binary file must have. Equal corners become one point.
// Error naming `source` and the fault.
Mesh ParseStl(std::string_view bytes, const std::string& source);

// Binary STL. Error naming `source` where the mesh has no triangles.
std::string FormatStl(const Mesh& mesh, const std::string& source);

}  // namespace sandwright
