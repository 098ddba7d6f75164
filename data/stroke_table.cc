#include "data/stroke_table.h"

#include <spdlog/fmt/fmt.h>

#include <map>
#include <sstream>

#include "data/base/atomic_file.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

std::vector<std::string> Cells(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) {
    const size_t begin = cell.find_first_not_of(" \t\r"), end = cell.find_last_not_of(" \t\r");
    cells.push_back(begin == std::string::npos ? "" : cell.substr(begin, end - begin + 1));
  }
  return cells;
}

// One line, by the names of its columns.
class Row {
 public:
  Row(const std::map<std::string, size_t>& columns, const std::string& line, std::string where)
      : columns_(columns), cells_(Cells(line)), where_(std::move(where)) {}

  std::string Text(const std::string& column) const {
    const auto found = columns_.find(column);
    return found == columns_.end() || found->second >= cells_.size() ? "" : cells_[found->second];
  }
  double Number(const std::string& column) const {
    const std::string text = Text(column);
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != '\0')
      throw Error(fmt::format("{}: {} is \"{}\"; a number is needed", where_, column, text));
    return value;
  }
  const std::string& where() const { return where_; }

 private:
  const std::map<std::string, size_t>& columns_;
  std::vector<std::string> cells_;
  std::string where_;
};

std::map<std::string, size_t> Columns(const std::string& line, const std::string& file) {
  std::map<std::string, size_t> columns;
  for (const std::string& name : Cells(line)) columns.try_emplace(name, columns.size());
  for (const char* name : {"stroke", "x_mm", "y_mm", "z_mm", "degree", "speed_mps"})
    if (!columns.contains(name))
      throw Error(fmt::format("{}: its first line has no column \"{}\"; needed: stroke, x_mm, y_mm, z_mm, degree, speed_mps",
                              file, name));
  return columns;
}

}  // namespace

std::vector<StrokeRow> ReadStrokeTable(const std::filesystem::path& file) {
  std::istringstream in(ReadFile(file));
  std::string line, current;
  std::getline(in, line);
  const auto columns = Columns(line, file.string());
  std::vector<StrokeRow> rows;
  for (int number = 2; std::getline(in, line); ++number) {
    if (Cells(line).empty()) continue;
    const Row row(columns, line, fmt::format("{}: line {}", file.string(), number));
    if (rows.empty() || row.Text("stroke") != current) {
      if (!rows.empty()) CheckStroke(rows.back().stroke, fmt::format("{}: stroke {}", file.string(), current));
      current = row.Text("stroke");
      rows.push_back({{{}, static_cast<int>(row.Number("degree")), row.Number("speed_mps")}, row.Text("before"), row.Text("after")});
    }
    rows.back().stroke.control_points_m.emplace_back(row.Number("x_mm") / 1000, row.Number("y_mm") / 1000,
                                                     row.Number("z_mm") / 1000);
  }
  if (rows.empty()) throw Error(file.string() + ": it holds no strokes");
  CheckStroke(rows.back().stroke, fmt::format("{}: stroke {}", file.string(), current));
  return rows;
}

void WriteStrokeTable(const std::vector<Stroke>& strokes, const std::filesystem::path& file) {
  std::string text = "stroke,point,x_mm,y_mm,z_mm,degree,speed_mps\n";
  for (size_t i = 0; i < strokes.size(); ++i) {
    const auto& points = strokes[i].control_points_m;
    for (size_t k = 0; k < points.size(); ++k)
      text += fmt::format("{},{},{},{},{},{},{}\n", i, k, 1000 * points[k].x(), 1000 * points[k].y(), 1000 * points[k].z(),
                          strokes[i].degree, strokes[i].speed_mps);
  }
  WriteFileAtomically(file, text);
}

}  // namespace sandwright
