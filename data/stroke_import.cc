#include "data/stroke_import.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "data/npy.h"
#include "data/stroke_table.h"

namespace sandwright {
namespace {

constexpr double kPathStep_m = 0.002;

void Add(HeightMap before, HeightMap after, const Stroke& stroke, const Blade& blade, const std::string& where,
         StrokeFile& content) {
  CheckHeightMap(before, where + ": before");
  CheckHeightMap(after, where + ": after");
  CheckStroke(stroke, where);
  const auto& last = content.strokes;
  if (!before.SameGrid(after) || (!last.empty() && !before.SameGrid(last.front().before)))
    throw Error(fmt::format("{}: before has {} x {} cells of {:g} m, after {} x {} of {:g} m; all maps of a file must "
                            "have one grid",
                            where, before.rows, before.columns, before.cell_size_m, after.rows, after.columns, after.cell_size_m));
  const bool follows = !last.empty() && last.back().after.height_m == before.height_m;
  const int64_t sequence = last.empty() ? 0 : last.back().sequence + (follows ? 0 : 1);
  const int64_t step = follows ? last.back().step + 1 : 0;
  content.strokes.push_back({.before = std::move(before), .after = std::move(after), .stroke = stroke,
                             .path = SamplePath(stroke, kPathStep_m), .blade = blade, .sequence = sequence,
                             .step = step, .replicate_of = {}});
}

// An array whose first extent is the number of strokes.
NpyArray Read(const std::filesystem::path& file, const char* name, size_t rank, size_t strokes) {
  NpyArray array = ReadNumpy(file, name);
  if (array.shape.size() != rank || (strokes != 0 && array.shape[0] != strokes))
    throw Error(fmt::format("{}: array {} has shape [{}]; expected rank {}{}", file.string(), name, fmt::join(array.shape, ", "),
                            rank, strokes == 0 ? "" : fmt::format(" with {} strokes first", strokes)));
  return array;
}

HeightMap MapOf(const NpyArray& maps, size_t n, double cell_size_m) {
  HeightMap map(static_cast<int>(maps.shape[1]), static_cast<int>(maps.shape[2]), cell_size_m);
  for (size_t i = 0; i < map.size(); ++i) map.height_m[i] = static_cast<float>(maps.values[n * map.size() + i]);
  return map;
}

std::filesystem::path Beside(const std::filesystem::path& table, const std::string& name) {
  return table.parent_path() / name;  // a full path stays what it is
}

}  // namespace

StrokeFile ImportedStrokes(const std::filesystem::path& origin, Datum datum) {
  const std::string name = origin.filename().string();
  const nlohmann::json material = {{"imported_from", name}, {"datum", datum == Datum::kFloor ? "floor" : "relative"}};
  return {.source = "imported", .bed = name, .seed = 0, .material = material.dump(), .strokes = {}};
}

StrokeFile ReadStrokesNpz(const std::filesystem::path& file, const Blade& blade, Datum datum,
                          const std::optional<double>& cell_size_m) {
  const NpyArray before = Read(file, "before_m", 3, 0);
  const size_t count = before.shape[0];
  if (count == 0) throw Error(file.string() + ": it holds no strokes");
  const NpyArray after = Read(file, "after_m", 3, count), points = Read(file, "control_points_m", 3, count),
                 degree = Read(file, "degree", 1, count), speed = Read(file, "speed_mps", 1, count);
  const double cell_m = cell_size_m ? *cell_size_m : Read(file, "cell_size_m", 0, 0).values.at(0);
  if (points.shape[2] != 3)
    throw Error(fmt::format("{}: control_points_m has {} numbers a point; expected 3", file.string(), points.shape[2]));
  StrokeFile content = ImportedStrokes(file, datum);
  for (size_t n = 0; n < count; ++n) {
    Stroke stroke{{}, static_cast<int>(degree.values[n]), speed.values[n]};
    for (size_t k = 0; k < points.shape[1]; ++k) {
      const double* p = &points.values[(n * points.shape[1] + k) * 3];
      if (!std::isnan(p[0])) stroke.control_points_m.emplace_back(p[0], p[1], p[2]);
    }
    Add(MapOf(before, n, cell_m), MapOf(after, n, cell_m), stroke, blade, fmt::format("{}: stroke {}", file.string(), n), content);
  }
  return content;
}

StrokeFile ReadStrokesCsv(const std::filesystem::path& file, const Blade& blade, const MapFileOptions& options) {
  StrokeFile content = ImportedStrokes(file, options.datum);
  for (const StrokeRow& row : ReadStrokeTable(file)) {
    const std::string where = fmt::format("{}: stroke {}", file.string(), content.strokes.size());
    if (!IsMapFile(row.before) || !IsMapFile(row.after))
      throw Error(fmt::format("{}: before is \"{}\", after is \"{}\"; both must name height map files", where, row.before, row.after));
    Add(ReadMapFile(Beside(file, row.before), options), ReadMapFile(Beside(file, row.after), options), row.stroke, blade, where,
        content);
  }
  return content;
}

}  // namespace sandwright
