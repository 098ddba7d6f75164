#include "data/stl.h"

#include <spdlog/fmt/fmt.h>

#include <Eigen/Geometry>
#include <map>
#include <sstream>
#include <tuple>

#include "data/mesh_bytes.h"

namespace sandwright {
namespace {

constexpr size_t kHeader = 84, kTriangle = 50;  // bytes

// Gathers corners; STL repeats a point in each of its triangles.
class Corners {
 public:
  void Add(double x, double y, double z) {
    const auto [at, added] =
        index_.try_emplace({x, y, z}, static_cast<uint32_t>(mesh.points.size()));
    if (added) mesh.points.emplace_back(x, y, z);
    triangle_[filled_++] = at->second;
    if (filled_ < 3) return;
    mesh.triangles.push_back(triangle_);
    filled_ = 0;
  }
  Mesh mesh;

 private:
  std::map<std::tuple<double, double, double>, uint32_t> index_;
  std::array<uint32_t, 3> triangle_{};
  size_t filled_ = 0;
};

Mesh ParseBinary(std::string_view bytes, uint32_t count) {
  Corners corners;
  for (size_t t = 0; t < count; ++t) {
    for (size_t corner = 0; corner < 3; ++corner) {
      const std::string_view at = bytes.substr(kHeader + t * kTriangle + 12 + corner * 12);
      corners.Add(NumberAt<float>(at), NumberAt<float>(at.substr(4)), NumberAt<float>(at.substr(8)));
    }
  }
  return std::move(corners.mesh);
}

Mesh ParseAscii(std::string_view bytes, const std::string& source) {
  std::istringstream in{std::string(bytes)};
  Corners corners;
  std::string line, word;
  int number = 0, of_facet = 0;
  bool ended = false;
  const auto fail = [&](const std::string& what) {
    throw Error(fmt::format("{}: line {}: {}", source, number, what));
  };
  while (!ended && std::getline(in, line)) {
    ++number;
    std::istringstream words(line);
    if (!(words >> word)) continue;
    if (word == "facet") of_facet = 0;
    if (word == "vertex") {
      double x, y, z;
      if (!(words >> x >> y >> z)) fail("a vertex needs three numbers");
      corners.Add(x, y, z);
      ++of_facet;
    }
    if (word == "endfacet" && of_facet != 3) fail(fmt::format("a facet with {} corners; allowed: 3", of_facet));
    ended = word == "endsolid";
  }
  if (!ended) fail("the file is cut off: no endsolid");
  return std::move(corners.mesh);
}

}  // namespace

Mesh ParseStl(std::string_view bytes, const std::string& source) {
  // Binary files may begin with "solid" too, so their length decides.
  const uint32_t count = bytes.size() >= kHeader ? NumberAt<uint32_t>(bytes.substr(80)) : 0;
  const size_t needed = kHeader + kTriangle * count;
  if (bytes.size() >= kHeader && bytes.size() == needed) return ParseBinary(bytes, count);
  if (bytes.starts_with("solid") && bytes.find("facet") != std::string_view::npos)
    return ParseAscii(bytes, source);
  if (bytes.size() < kHeader)
    throw Error(fmt::format("{}: no STL file, or cut off: {} bytes", source, bytes.size()));
  throw Error(fmt::format("{}: no STL file, or damaged: its {} triangles need {} bytes; there are {}",
                          source, count, needed, bytes.size()));
}

std::string FormatStl(const Mesh& mesh, const std::string& source) {
  if (mesh.triangles.empty()) throw Error(source + ": an STL file holds triangles, and there are none");
  std::string bytes = "sandwright surface";
  bytes.resize(80, ' ');
  Append(bytes, static_cast<uint32_t>(mesh.triangles.size()));
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
    for (const Eigen::Vector3d& v : {Eigen::Vector3d((b - a).cross(c - a).normalized()), a, b, c})
      for (int axis = 0; axis < 3; ++axis) Append(bytes, static_cast<float>(v[axis]));
    Append(bytes, uint16_t{0});
  }
  return bytes;
}

}  // namespace sandwright
