#include "data/ply.h"

#include <spdlog/fmt/fmt.h>

#include <map>
#include <optional>
#include <sstream>

#include "data/mesh_bytes.h"

namespace sandwright {
namespace {

struct Property {
  std::string name, type;
  std::string count_type;  // of a list; empty: one number
};

struct Element {
  std::string name;
  size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  std::string format;
  std::vector<Element> elements;
  size_t end = 0;  // bytes
};

// Types by either of their names.
const std::map<std::string, char> kTypes = {
    {"char", 'b'},  {"int8", 'b'},   {"uchar", 'B'}, {"uint8", 'B'},   {"short", 'h'},  {"int16", 'h'},
    {"ushort", 'H'}, {"uint16", 'H'}, {"int", 'i'},   {"int32", 'i'},   {"uint", 'I'},   {"uint32", 'I'},
    {"float", 'f'}, {"float32", 'f'}, {"double", 'd'}, {"float64", 'd'}};

[[noreturn]] void Fail(const std::string& source, const std::string& what) {
  throw Error(source + ": " + what);
}

Header ParseHeader(std::string_view bytes, const std::string& source) {
  if (!bytes.starts_with("ply")) Fail(source, "not a PLY file");
  const size_t last = bytes.find("end_header");
  const size_t end = last == std::string_view::npos ? last : bytes.find('\n', last);
  if (end == std::string_view::npos) Fail(source, "the file is cut off: no end_header");
  Header header{.format = "", .elements = {}, .end = end + 1};
  std::istringstream in{std::string(bytes.substr(0, last))};
  std::string line, word;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    words >> word;
    bool good = true;
    if (word == "format") {
      good = static_cast<bool>(words >> header.format);
    } else if (word == "element") {
      Element element;
      good = static_cast<bool>(words >> element.name >> element.count);
      header.elements.push_back(std::move(element));
    } else if (word == "property") {
      Property p;
      good = static_cast<bool>(words >> p.type);
      if (p.type == "list") good = static_cast<bool>(words >> p.count_type >> p.type);
      good = good && (words >> p.name) && kTypes.contains(p.type) && !header.elements.empty() &&
             (p.count_type.empty() || kTypes.contains(p.count_type));
      if (good) header.elements.back().properties.push_back(std::move(p));
    }
    if (!good) Fail(source, "the header's line \"" + line + "\" cannot be read");
  }
  if (header.format != "ascii" && header.format != "binary_little_endian" && header.format != "binary_big_endian")
    Fail(source, fmt::format("format \"{}\"; allowed: ascii, binary_little_endian, binary_big_endian", header.format));
  return header;
}

// The numbers of the body, one after another, whatever their form.
class Body {
 public:
  Body(std::string_view bytes, const Header& header, const std::string& source)
      : left_(bytes.substr(header.end)), ascii_(header.format == "ascii"),
        big_endian_(header.format == "binary_big_endian"), source_(source) {}

  double Next(const std::string& type) {
    if (ascii_) return NextWord();
    switch (kTypes.at(type)) {
      case 'b': return Take<int8_t>();
      case 'B': return Take<uint8_t>();
      case 'h': return Take<int16_t>();
      case 'H': return Take<uint16_t>();
      case 'i': return Take<int32_t>();
      case 'I': return Take<uint32_t>();
      case 'f': return Take<float>();
      default: return Take<double>();
    }
  }

 private:
  template <class T>
  double Take() {
    if (left_.size() < sizeof(T)) Fail(source_, "the file is cut off");
    const T value = NumberAt<T>(left_, big_endian_);
    left_.remove_prefix(sizeof(T));
    return static_cast<double>(value);
  }
  double NextWord() {
    const size_t begin = left_.find_first_not_of(" \t\r\n");
    if (begin == std::string_view::npos) Fail(source_, "the file is cut off");
    left_.remove_prefix(begin);
    const std::string word(left_.substr(0, left_.find_first_of(" \t\r\n")));
    left_.remove_prefix(word.size());
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (end == word.c_str() || *end != '\0') Fail(source_, "\"" + word + "\" is not a number");
    return value;
  }

  std::string_view left_;
  bool ascii_, big_endian_;
  const std::string& source_;
};

void AddFace(const std::vector<double>& corners, size_t points, Mesh& mesh, const std::string& source) {
  for (double corner : corners)
    if (!(corner >= 0 && corner < static_cast<double>(points)))
      Fail(source, fmt::format("face {} names point {}; allowed: 0..{}", mesh.triangles.size(), corner,
                               static_cast<double>(points) - 1));
  for (size_t i = 2; i < corners.size(); ++i)
    mesh.triangles.push_back({static_cast<uint32_t>(corners[0]), static_cast<uint32_t>(corners[i - 1]),
                              static_cast<uint32_t>(corners[i])});
}

}  // namespace

Mesh ParsePly(std::string_view bytes, const std::string& source) {
  const Header header = ParseHeader(bytes, source);
  Body body(bytes, header, source);
  Mesh mesh;
  for (const Element& element : header.elements) {
    for (size_t n = 0; n < element.count; ++n) {
      std::array<std::optional<double>, 3> p;
      for (const Property& property : element.properties) {
        if (property.count_type.empty()) {
          const double value = body.Next(property.type);
          if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
            p[static_cast<size_t>(property.name[0] - 'x')] = value;
          continue;
        }
        std::vector<double> list;
        for (double count = body.Next(property.count_type); count > 0; --count)
          list.push_back(body.Next(property.type));
        if (element.name == "face" && property.name.starts_with("vertex_ind"))
          AddFace(list, mesh.points.size(), mesh, source);
      }
      if (element.name != "vertex") continue;
      if (!p[0] || !p[1] || !p[2]) Fail(source, "its element vertex has no x, y and z");
      mesh.points.emplace_back(*p[0], *p[1], *p[2]);
    }
  }
  return mesh;
}

std::string FormatPly(const Mesh& mesh) {
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment sandwright surface\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\nelement face {}\n"
      "property list uchar int vertex_indices\nend_header\n",
      mesh.points.size(), mesh.triangles.size());
  for (const Eigen::Vector3d& p : mesh.points)
    for (int axis = 0; axis < 3; ++axis) Append(bytes, static_cast<float>(p[axis]));
  for (const auto& t : mesh.triangles) {
    Append(bytes, uint8_t{3});
    for (uint32_t corner : t) Append(bytes, static_cast<int32_t>(corner));
  }
  return bytes;
}

}  // namespace sandwright
