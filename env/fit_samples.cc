#include "env/fit_samples.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "data/base/atomic_file.h"
#include "data/base/sha256.h"
#include "env/coarse_heightfield.h"
#include "env/model_origin.h"

namespace sandwright {
namespace {

void CheckBlade(const StrokeRecord& record, const Blade& blade, const std::string& name) {
  if (std::abs(record.blade.width_m - blade.width_m) > 1e-6 ||
      std::abs(record.blade.thickness_m - blade.thickness_m) > 1e-6)
    throw Error(fmt::format("{}: the blade is {} x {} m; the model is for {} x {} m", name,
                            record.blade.width_m, record.blade.thickness_m, blade.width_m,
                            blade.thickness_m));
}

bool Unmoved(const Placement& p) { return p.turn_rad == 0 && p.shift_x_m == 0 && p.shift_y_m == 0; }

bool Seen(const HeightMap& map, size_t cell) { return map.valid.empty() || map.valid[cell] != 0; }

// The file by as many of its folders as tell it from those before: every rig's log has a strokes.h5.
std::string NameAmong(const std::map<std::string, std::string>& taken,
                      const std::filesystem::path& file) {
  std::filesystem::path folder = std::filesystem::absolute(file).lexically_normal().parent_path(),
                        name = file.filename();
  for (; taken.contains(name.string()) && folder.has_relative_path(); folder = folder.parent_path())
    name = folder.filename() / name;
  return name.string();
}

}  // namespace

FitStrokes ReadFitStrokes(const std::vector<std::filesystem::path>& files, const Blade& blade,
                          std::optional<double> cell_size_m) {
  FitStrokes result;
  for (const auto& path : files) {
    StrokeFile file = ReadStrokeFile(path);
    result.beds.insert(file.bed);
    result.sha256[NameAmong(result.sha256, path)] = Sha256Hex(ReadFile(path));
    for (size_t i = 0; i < file.strokes.size(); ++i) {
      StrokeRecord& record = file.strokes[i];
      const std::string name = fmt::format("{}, stroke {}", path.string(), i);
      CheckBlade(record, blade, name);
      if (cell_size_m) Resample(record.before, *cell_size_m);  // says where they do not divide it
      size_t behind = 0;
      if (i > 0 && record.sequence == result.strokes.back().record.sequence &&
          record.step == result.strokes.back().record.step + 1)
        behind = result.strokes.back().behind + 1;
      result.strokes.push_back({name, std::move(record), behind});
    }
  }
  if (!files.empty() && result.strokes.empty()) throw Error("the stroke files hold no stroke");
  return result;
}

void CheckSplit(const FitStrokes& data, const FitStrokes& validation) {
  for (const std::string& bed : validation.beds) {
    if (data.beds.contains(bed))
      throw Error("bed '" + bed +
                  "' is in both --data and --validation; split by bed, never by stroke");
  }
}

nlohmann::json SplitIdentity(const FitStrokes& data, const FitStrokes& validation,
                             const std::optional<std::filesystem::path>& init) {
  const auto identity = [](const FitStrokes& part) {
    return nlohmann::json{{"strokes", part.strokes.size()},
                          {"beds", part.beds},
                          {"files_sha256", part.sha256}};
  };
  nlohmann::json json = {{"training", identity(data)}, {"validation", identity(validation)}};
  if (init)
    json["init"] = DataOf(ReadSafetensors(*init), init->string());
  return json;
}

std::string Millimetres(double value_mm) { return fmt::format("{:.3f} mm", value_mm); }

std::string ValidationNote(double rmse_mm, double best_mm, double start_mm) {
  return "validation " + Millimetres(rmse_mm) + ", best " + Millimetres(best_mm) + ", at first " +
         Millimetres(start_mm);
}

HeightMap Place(const HeightMap& map, const Placement& placement, double cell_size_m) {
  HeightMap placed = Resample(map, cell_size_m);
  if (Unmoved(placement)) return placed;
  if (placed.valid.empty()) placed.valid.assign(placed.size(), 1);
  const double c = std::cos(placement.turn_rad), s = std::sin(placement.turn_rad);
  const double middle_x_m = map.width_m() / 2, middle_y_m = map.depth_m() / 2;
  const int parts = std::max(static_cast<int>(std::lround(cell_size_m / map.cell_size_m)), 1);
  for (int row = 0; row < placed.rows; ++row) {
    for (int column = 0; column < placed.columns; ++column) {
      double sum_m = 0;
      bool seen = true;
      for (int part = 0; part < parts * parts; ++part) {
        const double x_m = (column + (part % parts + 0.5) / parts) * cell_size_m -
                           placement.shift_x_m - middle_x_m;
        const double y_m =
            (row + (part / parts + 0.5) / parts) * cell_size_m - placement.shift_y_m - middle_y_m;
        const double from_x_m = c * x_m + s * y_m + middle_x_m;
        const double from_y_m = c * y_m - s * x_m + middle_y_m;
        sum_m += HeightAt(map, from_x_m, from_y_m);
        const int i = static_cast<int>(std::floor(from_x_m / map.cell_size_m)),
                  j = static_cast<int>(std::floor(from_y_m / map.cell_size_m));
        seen = seen && i >= 0 && j >= 0 && i < map.columns && j < map.rows &&
               Seen(map, map.Index(j, i));
      }
      const size_t cell = placed.Index(row, column);
      placed.height_m[cell] = static_cast<float>(sum_m / (parts * parts));
      placed.valid[cell] = seen;
    }
  }
  return placed;
}

ToolPath Place(const ToolPath& path, const Placement& placement, const HeightMap& map) {
  const double c = std::cos(placement.turn_rad), s = std::sin(placement.turn_rad);
  ToolPath placed = path;
  for (BladePose& pose : placed) {
    const double x_m = pose.x_m - map.width_m() / 2, y_m = pose.y_m - map.depth_m() / 2;
    pose.x_m = c * x_m - s * y_m + map.width_m() / 2 + placement.shift_x_m;
    pose.y_m = s * x_m + c * y_m + map.depth_m() / 2 + placement.shift_y_m;
    pose.yaw_rad += placement.turn_rad;
  }
  return placed;
}

FitSample MakeFitSample(const std::string& name, const HeightMap& before, const HeightMap& truth,
                        const ToolPath& path, const SurrogateConfig& model) {
  SandState state(before);
  if (model.net.uses_heightfield())
    ApplyOnCoarseCells(Heightfield(model.heightfield), static_cast<int>(model.heightfield_cells),
                       state, path);
  const HeightMap& start = state.map();
  FitSample sample{name,
                   start,
                   EncodeStroke(before, start, path, model.heightfield.blade, model.net.multiple(),
                                model.reach_m),
                   {},
                   {}};
  const CellRect& window = sample.input.window;
  if (window.empty()) throw Error(name + ": the path lies outside the box");
  sample.target.assign(static_cast<size_t>(sample.input.rows * sample.input.columns), 0.0f);
  sample.weight = sample.target;
  for (int row = window.row0; row < window.row1; ++row) {
    for (int column = window.column0; column < window.column1; ++column) {
      const size_t cell = before.Index(row, column);
      if (!Seen(before, cell) || !Seen(truth, cell)) continue;
      const auto at =
          static_cast<size_t>((row - window.row0) * sample.input.columns + column - window.column0);
      sample.target[at] = static_cast<float>(
          (static_cast<double>(truth.height_m[cell]) - start.height_m[cell]) / kResidualScale_m);
      sample.weight[at] = 1;
    }
  }
  return sample;
}

FitSample ApplySymmetry(const FitSample& sample, int symmetry) {
  SAND_CHECK(symmetry >= 0 && symmetry < 8, symmetry);
  const bool mirror_x = symmetry & 1, mirror_y = symmetry & 2, swap = symmetry & 4;
  const int rows = sample.input.rows, columns = sample.input.columns;
  FitSample out = sample;
  if (swap) std::swap(out.input.rows, out.input.columns);
  const auto turned = [&](int row, int column) {  // where a cell goes
    const int j = mirror_y ? rows - 1 - row : row, i = mirror_x ? columns - 1 - column : column;
    return static_cast<size_t>(swap ? i * rows + j : j * columns + i);
  };
  const auto turn = [&](const float* from, float* to, float sign) {
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column)
        to[turned(row, column)] = sign * from[row * columns + column];
    }
  };
  const auto plane = static_cast<size_t>(rows * columns);
  for (int c = 0; c < kSurrogateChannelCount; ++c) {
    // The direction of travel is a vector: it turns with the picture.
    const bool is_x = c == kDirectionXChannel, is_y = c == kDirectionXChannel + 1;
    const int to = swap && is_x ? c + 1 : swap && is_y ? c - 1 : c;
    const float sign = (is_x && mirror_x) || (is_y && mirror_y) ? -1.0f : 1.0f;
    turn(&sample.input.channels[static_cast<size_t>(c) * plane],
         &out.input.channels[static_cast<size_t>(to) * plane], sign);
  }
  turn(sample.target.data(), out.target.data(), 1);
  turn(sample.weight.data(), out.weight.data(), 1);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column)
      out.input.active[turned(row, column)] =
          sample.input.active[static_cast<size_t>(row * columns + column)];
  }
  return out;
}

}  // namespace sandwright
