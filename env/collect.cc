#include "env/collect.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <mutex>

#include "data/base/parallel.h"
#include "data/base/progress.h"
#include "data/stroke_dataset.h"

namespace sandwright {
namespace {

constexpr uint64_t kTerrain = StreamId("collect terrain"), kStroke = StreamId("collect stroke");

int WholeCells(double extent_m, double cell_size_m, const char* key) {
  const double cells = extent_m / cell_size_m;
  if (std::abs(cells - std::round(cells)) > 1e-6)
    throw Error(fmt::format("{} = {} m; must be a whole number of cells of cell_size_m = {} m", key, extent_m,
                            cell_size_m));
  return static_cast<int>(std::round(cells));
}

// What identifies the run: a file of other settings is never continued.
std::string Material(CollectConfig config) {
  config.heightfield.threads = 1;
  return ToJson(FieldsOf(config)).dump();
}

class Collector {
 public:
  Collector(const CollectConfig& config, const CollectRequest& request, const std::function<bool()>& stop)
      : config_(config),
        request_(request),
        stop_(stop),
        rows_(WholeCells(config.depth_m, config.cell_size_m, "depth_m")),
        columns_(WholeCells(config.width_m, config.cell_size_m, "width_m")),
        material_(Material(config)),
        model_(config.heightfield),
        progress_("collect", request.strokes, "strokes") {}

  Collected Run() {
    const int64_t beds = (request_.strokes + request_.sequence - 1) / request_.sequence;
    ParallelFor(static_cast<int>(beds), request_.threads, [&](int bed) { CollectBed(bed); });
    return total_;
  }

 private:
  std::filesystem::path FileOf(int64_t bed) const {
    return request_.out.extension() == ".h5" ? request_.out : request_.out / fmt::format("bed_{:05}.h5", bed);
  }

  // What is on file of a bed, checked, or a bed without strokes.
  StrokeFile Open(int64_t bed) const {
    const std::filesystem::path file = FileOf(bed);
    const auto seed = static_cast<int64_t>(request_.seed);
    if (!std::filesystem::exists(file))
      return {"heightfield", fmt::format("heightfield_{}_{:05}", request_.seed, bed), seed, material_, {}};
    StrokeFile content = ReadStrokeFile(file);
    if (content.source != "heightfield" || content.seed != seed || content.material != material_)
      throw Error(fmt::format("{}: source {}, seed {}; it holds strokes of other settings than asked for "
                              "(heightfield, seed {}): choose another --out, or the settings in its attribute "
                              "material", file.string(), content.source, content.seed, request_.seed));
    return content;
  }

  HeightMap Terrain(int64_t bed) const {
    RandomStream stream(request_.seed, kTerrain, static_cast<uint64_t>(bed));
    return GenerateTerrain(config_.terrain, rows_, columns_, config_.cell_size_m, stream);
  }

  StrokeRecord NextStroke(const StrokeFile& content, int64_t bed) const {
    StrokeRecord record;
    record.sequence = bed;
    record.step = static_cast<int64_t>(content.strokes.size());
    record.blade = model_.blade();
    record.before = content.strokes.empty() ? Terrain(bed) : content.strokes.back().after;
    RandomStream stream(request_.seed, kStroke, static_cast<uint64_t>(bed) << 32 | static_cast<uint64_t>(record.step));
    record.stroke = DrawStroke(config_.excavation, record.before, stream);
    record.path = SamplePath(record.stroke, config_.cell_size_m / 2);
    std::vector<SandState> state = {SandState(record.before)};
    model_.Apply(state, std::span<const ToolPath>(&record.path, 1));
    record.after = state[0].map();
    return record;
  }

  void CollectBed(int64_t bed) {
    const int64_t wanted = std::min(request_.sequence, request_.strokes - bed * request_.sequence);
    StrokeFile content;
    {
      const std::lock_guard lock(files_);  // the HDF5 library serves one thread at a time
      content = Open(bed);
      total_.strokes += std::min(wanted, static_cast<int64_t>(content.strokes.size()));
    }
    while (static_cast<int64_t>(content.strokes.size()) < wanted && !stop_()) {
      content.strokes.push_back(NextStroke(content, bed));
      const std::lock_guard lock(files_);
      WriteStrokeFile(content, FileOf(bed));
      ++total_.added;
      progress_.Update(++total_.strokes);
    }
  }

  const CollectConfig& config_;
  const CollectRequest& request_;
  const std::function<bool()>& stop_;
  int rows_, columns_;
  std::string material_;
  Heightfield model_;
  Progress progress_;
  std::mutex files_;
  Collected total_;
};

}  // namespace

Collected Collect(const CollectConfig& config, const CollectRequest& request,
                  const std::function<bool()>& stop) {
  if (request.strokes < 1 || request.sequence < 1)
    throw Error(fmt::format("strokes = {}, sequence = {}; both must be at least 1", request.strokes, request.sequence));
  if (request.out.extension() == ".h5" && request.strokes > request.sequence)
    throw Error(fmt::format("{}: one file holds one bed, and {} strokes at {} a bed need several; name a folder",
                            request.out.string(), request.strokes, request.sequence));
  if (request.out.extension() != ".h5") std::filesystem::create_directories(request.out);
  return Collector(config, request, stop).Run();
}

}  // namespace sandwright
