// sandwright convert: height maps, strokes and recorded strokes to and from the files of other programs.
#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "cli/command.h"
#include "cli/convert_strokes.h"

namespace sandwright {
namespace {

class ConvertCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("in", in_, "file to read, or a folder of picture pairs")->required();
    app.add_option("out", out_, "file to write")->required();
    app.add_option("--unit", map_.unit, "of the other format's numbers: mm or m (NPY, NPZ, TIFF, meshes, XYZ)")
        ->check(CLI::IsMember({"mm", "m"}));
    app.add_option("--cell-size", map_.cell_size_m, "cells of the map [m], where the file carries no grid")
        ->check(CLI::Range(1e-5, 10.0));
    auto* range = app.add_option("--range-mm", range_mm_, "PNG: heights of black and of white [mm]")->expected(2);
    app.add_option("--mm-per-level", mm_per_level_, "PNG: height of a level above the one below it; level 0 is 0 mm")
        ->check(CLI::Range(1e-6, 1e3))
        ->excludes(range);
    app.add_option("--hole-level", map_.hole_level, "PNG: the level that stands for a hole")
        ->check(CLI::Range(0, 65535));
    app.add_flag("--fill", map_.fill_holes, "close holes by what spans them");
    app.add_flag("--goal", map_.holes_do_not_count, "what is read is a goal: its holes do not count");
    app.add_option("--datum", datum_, "zero of the heights that are read: relative (default) or floor")
        ->check(CLI::IsMember({"relative", "floor"}));
    app.add_flag("--strokes", strokes_, "a .npz or .png holds recorded strokes, not a map");
  }
  void Fields(FieldList& f) override { f.Section("blade", blade_); }

  int Run() override {
    map_.datum = datum_ == "floor" ? Datum::kFloor : Datum::kRelative;
    if (!range_mm_.empty()) {
      map_.low_m = range_mm_[0] / 1000;
      map_.high_m = range_mm_[1] / 1000;
    }
    if (mm_per_level_) map_.step_m = *mm_per_level_ / 1000;
    if (IsStrokesFile(out_)) {
      const std::vector<Stroke> strokes = ReadStrokesOf(in_);
      WriteStrokesTo(strokes, blade_, out_);
      return Tell(strokes.size());
    }
    if (out_.extension() == ".h5" && (strokes_ || std::filesystem::is_directory(in_) || in_.extension() == ".csv")) {
      const StrokeFile content = ReadRecordedStrokes(in_, blade_, map_);
      WriteStrokeFile(content, out_);
      return Tell(content.strokes.size());
    }
    if (!IsMapFile(in_) || !IsMapFile(out_))
      throw Error(fmt::format("no way from \"{}\" to \"{}\"; maps: .h5 .png .npy .npz .tif .tiff .stl .obj .ply .xyz; strokes: "
                              ".yaml .h5 .csv to .dxf .svg .csv .yaml; recorded strokes: a folder or .png of picture pairs "
                              "or .npz (both with --strokes), .csv, to .h5",
                              in_.string(), out_.string()));
    return Map();
  }

 private:
  int Map() const {
    const HeightMap map = ReadMapFile(in_, map_);
    WriteMapFile(map, out_, map_);
    std::vector<float> heights_m = map.height_m;
    std::erase_if(heights_m, [](float h) { return std::isnan(h); });
    const auto [low_m, high_m] = std::ranges::minmax(heights_m);
    const auto holes = std::ranges::count(map.valid, 0) + std::ranges::count(map.mask, 0);
    fmt::print("{} x {} cells of {:g} mm, {:.2f} to {:.2f} mm high, {} holes: {}\n", map.columns, map.rows,
               1e3 * map.cell_size_m, 1e3 * low_m, 1e3 * high_m, holes, out_.string());
    WriteResult({{"kind", "map"}, {"out", out_.string()}, {"rows", map.rows}, {"columns", map.columns},
                 {"cell_size_m", map.cell_size_m}, {"lowest_m", low_m}, {"highest_m", high_m}, {"holes", holes},
                 {"datum", map.datum == Datum::kFloor ? "floor" : "relative"}});
    return 0;
  }
  int Tell(size_t strokes) const {
    fmt::print("{} strokes: {}\n", strokes, out_.string());
    WriteResult({{"kind", "strokes"}, {"out", out_.string()}, {"strokes", strokes}});
    return 0;
  }

  std::filesystem::path in_, out_;
  MapFileOptions map_;
  Blade blade_;
  std::vector<double> range_mm_;
  std::optional<double> mm_per_level_;
  std::string datum_ = "relative";
  bool strokes_ = false;
};

}  // namespace

std::unique_ptr<Command> MakeConvertCommand() { return std::make_unique<ConvertCommand>(); }

}  // namespace sandwright
