// Mesh files of other programs: STL, OBJ, PLY, and points as text (XYZ).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "data/mesh.h"

namespace sandwright {

// Whether a file is one of these by its extension: .stl, .obj, .ply, .xyz.
bool IsMeshFile(const std::filesystem::path& file);

// Reads by extension, in the file's own unit: STL binary or ASCII; OBJ (v and f; polygons become fans); PLY
// ASCII or binary of either byte order; XYZ: three or more numbers a line, # starts a comment.
// Error naming the file and the place in it: missing, cut off, damaged, not finite, no points.
Mesh ReadMesh(const std::filesystem::path& file);

// Writes by extension, whole or not at all: STL and PLY binary, little-endian, float32; OBJ and XYZ with the
// digits that float32 needs. STL holds triangles only: Error where there are none. XYZ leaves triangles out.
void WriteMesh(const Mesh& mesh, const std::filesystem::path& file);

}  // namespace sandwright
