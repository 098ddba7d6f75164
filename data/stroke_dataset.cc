#include "data/stroke_dataset.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "data/base/error.h"
#include "data/base/hdf5.h"

namespace sandwright {
namespace {

HeightMap ReadMap(const H5::Group& group, const std::string& name, double cell_size_m,
                  const std::string& where) {
  auto array = ReadArray<float>(group, name + "_m", where);
  HeightMap map;
  map.rows = static_cast<int>(array.rows);
  map.columns = static_cast<int>(array.columns);
  map.cell_size_m = cell_size_m;
  map.height_m = std::move(array.values);
  if (HasDataset(group, "valid_" + name)) {
    auto valid = ReadArray<uint8_t>(group, "valid_" + name, where);
    if (valid.values.size() != map.size())
      throw Error(fmt::format("{}: valid_{} has {} cells; {}_m has {}", where, name,
                              valid.values.size(), name, map.size()));
    map.valid = std::move(valid.values);
  }
  CheckHeightMap(map, where + "/" + name + "_m");
  return map;
}

// The speed of strokes that do not name their own, as the source's settings give it [m/s].
double CommonSpeed(const std::string& material) {
  const auto settings = nlohmann::json::parse(material, nullptr, /*allow_exceptions=*/false);
  const bool given =
      settings.is_object() && settings.contains("speed") && settings["speed"].is_number();
  return given ? settings["speed"].get<double>() : Stroke().speed_mps;
}

Blade ReadBlade(const H5::Group& group, const std::string& where) {
  const Blade blade{ReadNumber(group, "blade_width_m", where),
                    ReadNumber(group, "blade_thickness_m", where)};
  if (!(blade.width_m > 0 && blade.thickness_m > 0 &&
        std::isfinite(blade.width_m + blade.thickness_m)))
    throw Error(fmt::format("{}: the blade is {} x {} m; both must be > 0", where, blade.width_m,
                            blade.thickness_m));
  return blade;
}

StrokeRecord ReadRecord(const H5::Group& group, double cell_size_m, double speed_mps,
                        const std::string& where) {
  StrokeRecord record;
  record.before = ReadMap(group, "before", cell_size_m, where);
  record.after = ReadMap(group, "after", cell_size_m, where);
  if (!record.before.SameGrid(record.after))
    throw Error(fmt::format("{}: before_m is {} x {}, after_m is {} x {}", where,
                            record.before.rows, record.before.columns, record.after.rows,
                            record.after.columns));
  const auto points = ReadArray<double>(group, "control_points_m", where);
  if (points.columns != 3)
    throw Error(
        fmt::format("{}: control_points_m has {} columns; expected 3", where, points.columns));
  for (size_t i = 0; i < points.rows; ++i)
    record.stroke.control_points_m.emplace_back(points.values[3 * i], points.values[3 * i + 1],
                                                points.values[3 * i + 2]);
  record.stroke.degree = static_cast<int>(ReadInteger(group, "degree", where));
  record.stroke.speed_mps =
      HasAttribute(group, "speed_mps") ? ReadNumber(group, "speed_mps", where) : speed_mps;
  CheckStroke(record.stroke, where);
  const auto path = ReadArray<double>(group, "path_m", where);
  if (path.columns != 4 || path.rows < 2)
    throw Error(fmt::format("{}: path_m is {} x {}; expected at least 2 x 4", where, path.rows,
                            path.columns));
  for (size_t i = 0; i < path.rows; ++i) {
    const double* p = &path.values[4 * i];
    for (int k = 0; k < 4; ++k) {
      if (!std::isfinite(p[k]))
        throw Error(fmt::format("{}: path_m row {} is not finite", where, i));
    }
    record.path.push_back({p[0], p[1], p[2], p[3]});
  }
  record.blade = ReadBlade(group, where);
  record.sequence = ReadInteger(group, "sequence", where);
  record.step = ReadInteger(group, "step", where);
  if (HasAttribute(group, "replicate_of"))
    record.replicate_of = ReadText(group, "replicate_of", where);
  if (HasAttribute(group, "time")) record.time = ReadText(group, "time", where);
  return record;
}

void WriteRecord(const StrokeRecord& record, H5::Group& group) {
  const auto write_map = [&](const HeightMap& map, const std::string& name) {
    const auto rows = static_cast<size_t>(map.rows), columns = static_cast<size_t>(map.columns);
    WriteArray(group, name + "_m", map.height_m.data(), rows, columns);
    if (!map.valid.empty()) WriteArray(group, "valid_" + name, map.valid.data(), rows, columns);
  };
  write_map(record.before, "before");
  write_map(record.after, "after");
  std::vector<double> numbers;
  for (const auto& p : record.stroke.control_points_m)
    numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
  WriteArray(group, "control_points_m", numbers.data(), numbers.size() / 3, 3);
  numbers.clear();
  for (const BladePose& p : record.path)
    numbers.insert(numbers.end(), {p.x_m, p.y_m, p.z_m, p.yaw_rad});
  WriteArray(group, "path_m", numbers.data(), numbers.size() / 4, 4);
  WriteInteger(group, "degree", record.stroke.degree);
  WriteInteger(group, "sequence", record.sequence);
  WriteInteger(group, "step", record.step);
  WriteNumber(group, "speed_mps", record.stroke.speed_mps);
  WriteNumber(group, "blade_width_m", record.blade.width_m);
  WriteNumber(group, "blade_thickness_m", record.blade.thickness_m);
  if (record.replicate_of) WriteText(group, "replicate_of", *record.replicate_of);
  if (record.time) WriteText(group, "time", *record.time);
}

}  // namespace

StrokeFile ReadStrokeFile(const std::filesystem::path& file) {
  const std::string where = file.string();
  const H5::H5File h5 = OpenHdf5(file);
  CheckSchema(h5, where, "sandwright-strokes", 1);
  StrokeFile content;
  content.source = ReadText(h5, "source", where);
  content.seed = ReadInteger(h5, "seed", where);
  content.material = ReadText(h5, "material", where);
  content.bed = HasAttribute(h5, "bed") ? ReadText(h5, "bed", where) : file.stem().string();
  if (HasAttribute(h5, "workcell")) content.workcell = ReadText(h5, "workcell", where);
  const double cell_size_m = ReadNumber(h5, "cell_size_m", where);
  const double speed_mps = CommonSpeed(content.material);
  try {
    const H5::Group strokes = h5.openGroup("strokes");
    for (const std::string& name : GroupNames(strokes))
      content.strokes.push_back(
          ReadRecord(strokes.openGroup(name), cell_size_m, speed_mps, where + ":/strokes/" + name));
  } catch (const H5::Exception&) {
    throw Error(where + ": group /strokes is missing or cut off");
  }
  return content;
}

void WriteStrokeFile(const StrokeFile& content, const std::filesystem::path& file) {
  SAND_CHECK(!content.strokes.empty());
  WriteHdf5(file, [&](H5::H5File& h5) {
    WriteSchema(h5, "sandwright-strokes", 1);
    WriteText(h5, "source", content.source);
    WriteText(h5, "bed", content.bed);
    WriteText(h5, "material", content.material);
    WriteInteger(h5, "seed", content.seed);
    if (content.workcell) WriteText(h5, "workcell", *content.workcell);
    WriteNumber(h5, "cell_size_m", content.strokes.front().before.cell_size_m);
    H5::Group strokes = h5.createGroup("strokes");
    for (size_t i = 0; i < content.strokes.size(); ++i) {
      H5::Group group = strokes.createGroup(fmt::format("{:05}", i));
      WriteRecord(content.strokes[i], group);
    }
  });
}

std::vector<std::filesystem::path> FindStrokeFiles(const std::vector<std::string>& paths) {
  std::vector<std::filesystem::path> files;
  for (const std::string& path : paths) {
    const auto of_rig = std::filesystem::path(path) / "strokes.h5";
    if (std::filesystem::exists(of_rig)) {
      files.push_back(of_rig);
    } else if (std::filesystem::is_directory(path)) {
      for (const auto& entry : std::filesystem::directory_iterator(path)) {
        const auto& name = entry.path().filename().string();
        if (entry.path().extension() == ".h5" && !name.starts_with("."))
          files.push_back(entry.path());
      }
    } else if (std::filesystem::exists(path)) {
      files.push_back(path);
    } else {
      throw Error("cannot read " + path + ": no such file or folder");
    }
  }
  if (files.empty()) throw Error("no .h5 stroke files in the given files and folders");
  std::ranges::sort(files);
  return files;
}

}  // namespace sandwright
