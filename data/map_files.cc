#include "data/map_files.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "data/gridding.h"
#include "data/grey_levels.h"
#include "data/mesh_files.h"
#include "data/npy.h"
#include "data/tiff.h"

namespace sandwright {
namespace {

constexpr float kHole = std::numeric_limits<float>::quiet_NaN();

bool IsTiff(const std::string& extension) { return extension == ".tif" || extension == ".tiff"; }

double UnitSize(const MapFileOptions& options, const std::filesystem::path& file) {
  if (options.unit == "mm") return 1e-3;
  if (options.unit == "m") return 1;
  throw Error(fmt::format("{}: its format carries no unit; --unit is \"{}\"; allowed: mm, m", file.string(), options.unit));
}

double CellSize(const MapFileOptions& options, const std::filesystem::path& file) {
  if (!options.cell_size_m)
    throw Error(file.string() + ": it carries no grid; --cell-size M (in m) is needed");
  return *options.cell_size_m;
}

GreyScale Grey(const MapFileOptions& options, int highest, const std::filesystem::path& file) {
  GreyScale scale{options.low_m.value_or(0), options.step_m.value_or(0), options.hole_level};
  if (options.step_m.has_value() == options.high_m.has_value())
    throw Error(file.string() + ": its levels carry no unit; give either --range-mm LOW HIGH or --mm-per-level S");
  if (options.high_m) scale.step_m = (*options.high_m - scale.low_m) / highest;
  if (!(scale.step_m > 0)) throw Error(file.string() + ": HIGH must be above LOW in --range-mm LOW HIGH");
  return scale;
}

void Scale(HeightMap& map, double by) {
  for (float& h : map.height_m) h = static_cast<float>(h * by);
}

HeightMap ReadArrayFile(const std::filesystem::path& file, const MapFileOptions& options) {
  const NpyArray array = ReadNumpy(file);
  if (array.shape.size() != 2)
    throw Error(fmt::format("{}: a height map has rank 2; this array has rank {}", file.string(), array.shape.size()));
  HeightMap map(static_cast<int>(array.shape[0]), static_cast<int>(array.shape[1]), CellSize(options, file));
  const double unit_m = UnitSize(options, file);
  std::ranges::transform(array.values, map.height_m.begin(), [&](double h) { return static_cast<float>(h * unit_m); });
  return map;
}

HeightMap ReadTiffFile(const std::filesystem::path& file, const MapFileOptions& options) {
  const TiffImage image = ReadTiff(file);
  const double unit_m = UnitSize(options, file);
  const double cell_m = image.pixel_size ? *image.pixel_size * unit_m : CellSize(options, file);
  if (image.pixel_size && options.cell_size_m && std::abs(*options.cell_size_m / cell_m - 1) > 1e-6)
    throw Error(fmt::format("{}: --cell-size {} m; the file says {:g} m", file.string(), *options.cell_size_m, cell_m));
  HeightMap map(image.rows, image.columns, cell_m);
  for (int row = 0; row < map.rows; ++row)  // a picture has its first row at the top
    std::copy_n(&image.values[map.Index(map.rows - 1 - row, 0)], map.columns, &map.At(row, 0));
  Scale(map, unit_m);
  return map;
}

void WriteTiffFile(const HeightMap& map, double unit_m, const std::filesystem::path& file) {
  TiffImage image{map.rows, map.columns, std::vector<float>(map.size()), map.cell_size_m / unit_m};
  for (int row = 0; row < map.rows; ++row)
    std::copy_n(&map.height_m[map.Index(row, 0)], map.columns, &image.values[map.Index(map.rows - 1 - row, 0)]);
  for (float& h : image.values) h = static_cast<float>(h / unit_m);
  WriteTiff(image, file);
}

HeightMap ReadForeign(const std::filesystem::path& file, const MapFileOptions& options) {
  const std::string extension = file.extension().string();
  if (extension == ".png") {
    const double cell_m = CellSize(options, file);
    return ReadGreyLevels(file, Grey(options, HighestLevel(file), file), cell_m);
  }
  if (extension == ".npy" || extension == ".npz") return ReadArrayFile(file, options);
  if (IsTiff(extension)) return ReadTiffFile(file, options);
  Mesh mesh = ReadMesh(file);
  const double unit_m = UnitSize(options, file);
  for (Eigen::Vector3d& p : mesh.points) p *= unit_m;
  return HeightsOf(mesh, CellSize(options, file), file.string());
}

// NaN becomes a hole of a terrain or of a goal.
void NameHoles(HeightMap& map, const MapFileOptions& options, const std::string& where) {
  if (std::ranges::none_of(map.height_m, [](float h) { return std::isnan(h); })) return;
  map.valid.clear();
  for (float& h : map.height_m) {
    map.valid.push_back(!std::isnan(h));
    if (std::isnan(h)) h = 0;
  }
  if (std::ranges::count(map.valid, 1) == 0) throw Error(where + ": the map is all hole");
  FillHoles(map);
  if (options.holes_do_not_count) map.mask = map.valid;
  if (options.holes_do_not_count || options.fill_holes) map.valid.clear();
}

// The map with NaN in its holes, or with its holes spanned.
HeightMap WithPlainHoles(const HeightMap& map, bool filled) {
  HeightMap plain = map;
  for (size_t i = 0; i < map.size(); ++i) {
    const bool hole = (!map.valid.empty() && !map.valid[i]) || (!map.mask.empty() && !map.mask[i]);
    if (hole) plain.height_m[i] = kHole;
  }
  plain.valid.clear();
  plain.mask.clear();
  MapFileOptions fill;
  fill.fill_holes = filled;
  if (filled) NameHoles(plain, fill, "the map");
  return plain;
}

}  // namespace

bool IsMapFile(const std::filesystem::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".h5" || extension == ".png" || extension == ".npy" || extension == ".npz" ||
         IsTiff(extension) || IsMeshFile(file);
}

HeightMap ReadMapFile(const std::filesystem::path& file, const MapFileOptions& options) {
  SAND_CHECK(IsMapFile(file), file);
  if (file.extension() == ".h5") return ReadHeightMap(file, /*nan_allowed=*/true);
  HeightMap map = ReadForeign(file, options);
  map.datum = options.datum;
  CheckHeightMap(map, file.string(), /*nan_allowed=*/true);
  NameHoles(map, options, file.string());
  return map;
}

void WriteMapFile(const HeightMap& map, const std::filesystem::path& file, const MapFileOptions& options) {
  SAND_CHECK(IsMapFile(file), file);
  const std::string extension = file.extension().string();
  if (extension == ".h5") return WriteHeightMap(map, file);
  HeightMap plain = WithPlainHoles(map, options.fill_holes);
  if (extension == ".png") return WriteGreyLevels(plain, Grey(options, 65535, file), file);
  if (extension == ".npz") throw Error(file.string() + ": NPZ is read only; write .npy");
  const double unit_m = UnitSize(options, file);
  if (IsTiff(extension)) return WriteTiffFile(plain, unit_m, file);
  if (extension == ".npy") {
    Scale(plain, 1 / unit_m);
    return WriteNpy<float>(file, plain.height_m, {static_cast<size_t>(map.rows), static_cast<size_t>(map.columns)});
  }
  Mesh mesh = MeshOf(plain, file.string());
  for (Eigen::Vector3d& p : mesh.points) p /= unit_m;
  WriteMesh(mesh, file);
}

}  // namespace sandwright
