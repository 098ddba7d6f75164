#include "data/mesh_files.h"

#include <spdlog/fmt/fmt.h>

#include "data/base/atomic_file.h"
#include "data/obj.h"
#include "data/ply.h"
#include "data/stl.h"

namespace sandwright {

bool IsMeshFile(const std::filesystem::path& file) {
  const auto extension = file.extension();
  return extension == ".stl" || extension == ".obj" || extension == ".ply" || extension == ".xyz";
}

Mesh ReadMesh(const std::filesystem::path& file) {
  const std::string source = file.string();
  if (!IsMeshFile(file)) throw Error(source + ": not a mesh by its name; allowed: .stl, .obj, .ply, .xyz");
  const std::string bytes = ReadFile(file);
  const auto extension = file.extension();
  Mesh mesh = extension == ".stl"   ? ParseStl(bytes, source)
              : extension == ".obj" ? ParseObj(bytes, source)
              : extension == ".ply" ? ParsePly(bytes, source)
                                    : ParseXyz(bytes, source);
  if (mesh.points.empty()) throw Error(source + ": the mesh is empty: no points");
  for (size_t i = 0; i < mesh.points.size(); ++i)
    if (!mesh.points[i].allFinite()) throw Error(fmt::format("{}: point {} is not finite", source, i));
  return mesh;
}

void WriteMesh(const Mesh& mesh, const std::filesystem::path& file) {
  SAND_CHECK(IsMeshFile(file), file);
  const auto extension = file.extension();
  WriteFileAtomically(file, extension == ".stl"   ? FormatStl(mesh, file.string())
                            : extension == ".obj" ? FormatObj(mesh)
                            : extension == ".ply" ? FormatPly(mesh)
                                                  : FormatXyz(mesh));
}

}  // namespace sandwright
