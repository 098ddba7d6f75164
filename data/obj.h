// Wavefront OBJ: points and faces as text.
#pragma once

#include <string>
#include <string_view>

#include "data/mesh.h"

namespace sandwright {

// Lines v and f count (a polygon becomes a fan of triangles; negative indices count from the end); others are
// skipped. Error naming `source`, the line and the fault.
Mesh ParseObj(std::string_view text, const std::string& source);
std::string FormatObj(const Mesh& mesh);

// XYZ: one point a line, three or more numbers between blanks, commas or semicolons; # starts a comment.
Mesh ParseXyz(std::string_view text, const std::string& source);
std::string FormatXyz(const Mesh& mesh);

}  // namespace sandwright
