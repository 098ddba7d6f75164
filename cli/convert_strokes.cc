#include "cli/convert_strokes.h"

#include "data/stroke_drawing.h"
#include "data/stroke_import.h"
#include "data/stroke_table.h"
#include "env/paper_import.h"
#include "robot_model/plan.h"

namespace sandwright {
namespace {

bool IsPlan(const std::filesystem::path& file) {
  return file.extension() == ".yaml" || file.extension() == ".yml";
}

}  // namespace

bool IsStrokesFile(const std::filesystem::path& file) {
  const auto extension = file.extension();
  return extension == ".dxf" || extension == ".svg" || extension == ".csv" || IsPlan(file);
}

std::vector<Stroke> ReadStrokesOf(const std::filesystem::path& file) {
  if (IsPlan(file)) return ReadStrokes(file);
  std::vector<Stroke> strokes;
  if (file.extension() == ".csv") {
    for (const StrokeRow& row : ReadStrokeTable(file)) strokes.push_back(row.stroke);
  } else if (file.extension() == ".h5") {
    for (const StrokeRecord& record : ReadStrokeFile(file).strokes) strokes.push_back(record.stroke);
  } else {
    throw Error(file.string() + ": strokes are read from a plan (.yaml), a stroke file (.h5) or a table (.csv)");
  }
  return strokes;
}

void WriteStrokesTo(const std::vector<Stroke>& strokes, const Blade& blade, const std::filesystem::path& file) {
  SAND_CHECK(IsStrokesFile(file), file);
  if (file.extension() == ".dxf") return WriteStrokesDxf(strokes, file);
  if (file.extension() == ".svg") return WriteStrokesSvg(strokes, blade, file);
  if (file.extension() == ".csv") return WriteStrokeTable(strokes, file);
  WritePlan({.strokes = strokes, .seal = {}}, file);
}

StrokeFile ReadRecordedStrokes(const std::filesystem::path& path, const Blade& blade, const MapFileOptions& options) {
  if (path.extension() == ".csv") return ReadStrokesCsv(path, blade, options);
  if (path.extension() == ".npz") return ReadStrokesNpz(path, blade, options.datum, options.cell_size_m);
  return ReadPaperPairs(path, blade);
}

}  // namespace sandwright
