#include "data/obj.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <sstream>

namespace sandwright {
namespace {

[[noreturn]] void Fail(const std::string& source, int line, const std::string& what) {
  throw Error(fmt::format("{}: line {}: {}", source, line, what));
}

// "7", "7/1", "7/1/3" or "7//3": the point's index, from 1, or from the end where negative.
uint32_t PointIndex(const std::string& word, size_t points, const std::string& source, int line) {
  const auto count = static_cast<long>(points);
  char* end = nullptr;
  const long given = std::strtol(word.c_str(), &end, 10);
  const long index = given < 0 ? count + given : given - 1;
  if (end == word.c_str() || (*end != '\0' && *end != '/') || index < 0 || index >= count)
    Fail(source, line, fmt::format("face corner \"{}\"; allowed: 1..{} or -{}..-1", word, count, count));
  return static_cast<uint32_t>(index);
}

std::string Point(const char* lead, const Eigen::Vector3d& p) {
  // Nine digits give a float32 back as it was.
  return fmt::format("{}{:.9g} {:.9g} {:.9g}\n", lead, p.x(), p.y(), p.z());
}

}  // namespace

Mesh ParseObj(std::string_view text, const std::string& source) {
  std::istringstream in{std::string(text)};
  Mesh mesh;
  std::string line, word;
  for (int number = 1; std::getline(in, line); ++number) {
    std::istringstream words(line);
    if (!(words >> word)) continue;
    if (word == "v") {
      double x, y, z;
      if (!(words >> x >> y >> z)) Fail(source, number, "a point (v) needs three numbers");
      mesh.points.emplace_back(x, y, z);
    } else if (word == "f") {
      std::vector<uint32_t> corners;
      while (words >> word) corners.push_back(PointIndex(word, mesh.points.size(), source, number));
      if (corners.size() < 3)
        Fail(source, number, fmt::format("a face (f) with {} corners; at least 3 are needed", corners.size()));
      for (size_t i = 2; i < corners.size(); ++i)
        mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
    }
  }
  return mesh;
}

std::string FormatObj(const Mesh& mesh) {
  std::string text = "# sandwright surface\n";
  for (const Eigen::Vector3d& p : mesh.points) text += Point("v ", p);
  for (const auto& t : mesh.triangles)
    text += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return text;
}

Mesh ParseXyz(std::string_view text, const std::string& source) {
  std::istringstream in{std::string(text)};
  Mesh mesh;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    line = line.substr(0, line.find('#'));
    std::ranges::replace_if(line, [](char c) { return c == ',' || c == ';'; }, ' ');
    std::istringstream words(line);
    if (!(words >> std::ws) || words.peek() == EOF) continue;
    double x, y, z;
    if (!(words >> x >> y >> z)) Fail(source, number, "a point needs three numbers");
    mesh.points.emplace_back(x, y, z);
  }
  return mesh;
}

std::string FormatXyz(const Mesh& mesh) {
  std::string text;
  for (const Eigen::Vector3d& p : mesh.points) text += Point("", p);
  return text;
}

}  // namespace sandwright
