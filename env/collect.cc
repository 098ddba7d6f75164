#include "env/collect.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <mutex>

#include "data/base/parallel.h"
#include "data/base/progress.h"
#include "data/bed_pictures.h"
#include "data/stroke_dataset.h"
#include "env/dem.h"
#include "env/grains.h"

namespace sandwright {
namespace {

constexpr uint64_t kTerrain = StreamId("collect terrain"), kStroke = StreamId("collect stroke");

constexpr int kDraws = 10;  // of a stroke, where grains get lost

bool OfGrains(const CollectRequest& request) { return request.source == "dem"; }

// What identifies the run: a file of other settings is never continued.
std::string Material(CollectConfig config, bool grains) {
  config.heightfield.threads = 1;
  config.dem.ranks = 1;
  config.dem.cache.clear();
  nlohmann::json json = ToJson(FieldsOf(config));
  json.erase(grains ? "heightfield" : "dem");
  return json.dump();
}

std::unique_ptr<SandModel> MakeModel(const CollectConfig& config, bool grains) {
  if (grains) return std::make_unique<Dem>(config.dem);
  return std::make_unique<Heightfield>(config.heightfield);
}

// A bed on the way: what is on file, and the state that its next stroke starts from.
struct Bed {
  int64_t index = 0;
  StrokeFile content;
  std::optional<SandState> state;  // none: before the first stroke
};

class Collector {
 public:
  Collector(const CollectConfig& config, const CollectRequest& request,
            const std::function<bool()>& stop)
      : config_(config),
        request_(request),
        stop_(stop),
        rows_(WholeCells(config.depth_m, config.cell_size_m, "depth_m")),
        columns_(WholeCells(config.width_m, config.cell_size_m, "width_m")),
        material_(Material(config, OfGrains(request))),
        model_(MakeModel(config, OfGrains(request))),
        progress_("collect", request.strokes, "strokes", request.status) {}

  Collected Run() {
    const int64_t beds = (request_.strokes + request_.sequence - 1) / request_.sequence;
    ParallelFor(static_cast<int>(beds), request_.threads, [&](int bed) { CollectBed(bed); });
    return total_;
  }

 private:
  std::filesystem::path FileOf(int64_t bed) const {
    return request_.out.extension() == ".h5" ? request_.out
                                             : request_.out / fmt::format("bed_{:05}.h5", bed);
  }
  std::filesystem::path GrainFileOf(int64_t bed, size_t strokes) const {
    const std::filesystem::path file = FileOf(bed);
    return file.parent_path() / fmt::format(".{}_{:05}.grains", file.stem().string(), strokes);
  }

  // What is on file of a bed, checked, or a bed without strokes.
  Bed Open(int64_t index) const {
    const std::filesystem::path file = FileOf(index);
    const auto seed = static_cast<int64_t>(request_.seed);
    if (!std::filesystem::exists(file)) {
      const std::string name = fmt::format("{}_{}_{:05}", request_.source, request_.seed, index);
      return {index, {request_.source, name, seed, material_, {}}, std::nullopt};
    }
    Bed bed{index, ReadStrokeFile(file), std::nullopt};
    if (bed.content.source != request_.source || bed.content.seed != seed ||
        bed.content.material != material_)
      throw Error(fmt::format(
          "{}: source {}, seed {}; it holds strokes of other settings than asked for "
          "({}, seed {}): choose another --out, or the settings in its attribute "
          "material",
          file.string(), bed.content.source, bed.content.seed, request_.source, request_.seed));
    return bed;
  }

  HeightMap Terrain(int64_t index) const {
    RandomStream stream(request_.seed, kTerrain, static_cast<uint64_t>(index));
    return GenerateTerrain(config_.terrain, rows_, columns_, config_.cell_size_m, stream);
  }
  // Settling is dear and every bed is carved anew, so beds take turns with a few packings, whatever
  // the run; replicates have one each.
  uint64_t PackingSeed(int64_t index) const {
    constexpr int64_t kPool = 3;
    return static_cast<uint64_t>(config_.packings > 1 ? index : index % kPool);
  }

  // The bed as its last stroke left it. Takes the file lock.
  SandState Continue(const Bed& bed) {
    const HeightMap& map = bed.content.strokes.back().after;
    if (!OfGrains(request_)) return SandState(map);
    const std::filesystem::path file = GrainFileOf(bed.index, bed.content.strokes.size());
    if (!std::filesystem::exists(file))
      throw Error(fmt::format(
          "{}: the bed is finished, or its grains ({}) are gone, so no stroke can follow: "
          "choose another --out",
          FileOf(bed.index).string(), file.filename().string()));
    const std::lock_guard lock(files_);
    const H5::H5File h5 = OpenHdf5(file);
    return SandState(map, std::make_shared<const GrainBed>(GrainBed{
                              config_.width_m, config_.depth_m, ReadGrains(h5, file.string())}));
  }

  // Terrain, packing and names of the next stroke; bed.state is where it starts.
  StrokeRecord Prepare(Bed& bed) {
    StrokeRecord record;
    const auto done = static_cast<int64_t>(bed.content.strokes.size());
    record.sequence = bed.index;
    record.step = done;
    if (config_.packings > 1) {
      const int64_t base = done / config_.packings, packing = done % config_.packings;
      const int64_t place = bed.index << 20 | base;
      record.sequence = place;
      record.step = 0;
      if (packing > 0) record.replicate_of = fmt::format("{:05}", base * config_.packings);
      bed.state = model_->Start(Terrain(place), PackingSeed(packing));
    } else if (!bed.state) {
      bed.state =
          done == 0 ? model_->Start(Terrain(bed.index), PackingSeed(bed.index)) : Continue(bed);
    }
    return record;
  }

  RandomStream StrokeStream(const Bed& bed) const {
    const auto drawn = static_cast<uint64_t>(bed.content.strokes.size());
    return RandomStream(request_.seed, kStroke, static_cast<uint64_t>(bed.index) << 32 | drawn);
  }

  static const StrokeRecord& BaseOf(const Bed& bed, const StrokeRecord& replicate) {
    return bed.content.strokes[static_cast<size_t>(std::stol(*replicate.replicate_of))];
  }

  StrokeRecord NextStroke(Bed& bed) {
    StrokeRecord record = Prepare(bed);
    record.blade = model_->blade();
    record.before = bed.state->map();
    RandomStream stream = StrokeStream(bed);
    for (int draw = 0;; ++draw) {
      record.stroke = record.replicate_of ? BaseOf(bed, record).stroke
                                          : DrawStroke(config_.excavation, record.before, stream);
      record.path = SamplePath(record.stroke, config_.cell_size_m / 2);
      try {
        model_->Apply(std::span<SandState>(&*bed.state, 1),
                      std::span<const ToolPath>(&record.path, 1));
        record.after = bed.state->map();
        return record;
      } catch (const GrainsLost& e) {
        if (draw == kDraws) throw;
        spdlog::warn("{}: {}; another {} is drawn", FileOf(bed.index).string(), e.what(),
                     record.replicate_of ? "packing" : "one");
        if (!record.replicate_of) continue;
        // The stroke is given; the same one through the same grains would lose them again.
        const auto done = static_cast<int64_t>(bed.content.strokes.size());
        bed.state =
            model_->Start(Terrain(record.sequence),
                          PackingSeed(done % config_.packings + (draw + 1) * config_.packings));
        record.before = bed.state->map();
      }
    }
  }

  // Grains first: a stroke on file always has the grains that the next one needs.
  void Write(const Bed& bed, bool last) {
    const size_t strokes = bed.content.strokes.size();
    const bool keep = OfGrains(request_) && config_.packings == 1;
    if (keep && !last)
      WriteHdf5(GrainFileOf(bed.index, strokes),
                [&](H5::H5File& h5) { WriteGrains(bed.state->grains()->grains, h5); });
    WriteStrokeFile(bed.content, FileOf(bed.index));
    if (keep) std::filesystem::remove(GrainFileOf(bed.index, strokes - 1));
  }

  void CollectBed(int64_t index) {
    const int64_t wanted =
        std::min(request_.sequence, request_.strokes - index * request_.sequence);
    Bed bed;
    {
      const std::lock_guard lock(files_);  // the HDF5 library serves one thread at a time
      bed = Open(index);
      total_.strokes += std::min(wanted, static_cast<int64_t>(bed.content.strokes.size()));
      progress_.Update(total_.strokes);
    }
    while (static_cast<int64_t>(bed.content.strokes.size()) < wanted && !stop_()) {
      bed.content.strokes.push_back(NextStroke(bed));
      const std::lock_guard lock(files_);
      Write(bed, static_cast<int64_t>(bed.content.strokes.size()) == wanted);
      ++total_.added;
      if (request_.status) request_.status->Show(BedPictures(bed.state->map(), {}));
      progress_.Update(++total_.strokes);
    }
  }

  const CollectConfig& config_;
  const CollectRequest& request_;
  const std::function<bool()>& stop_;
  int rows_, columns_;
  std::string material_;
  std::unique_ptr<SandModel> model_;
  Progress progress_;
  std::mutex files_;
  Collected total_;
};

}  // namespace

Collected Collect(const CollectConfig& config, const CollectRequest& request,
                  const std::function<bool()>& stop) {
  if (request.strokes < 1 || request.sequence < 1)
    throw Error(fmt::format("strokes = {}, sequence = {}; both must be at least 1", request.strokes,
                            request.sequence));
  if (request.source != "heightfield" && request.source != "dem")
    throw Error(fmt::format("source {}: allowed: heightfield, dem", request.source));
  if (config.packings > 1 && !OfGrains(request))
    throw Error(fmt::format("packings = {}; only grains (source dem) are packed: must be 1",
                            config.packings));
  if (request.out.extension() == ".h5" && request.strokes > request.sequence)
    throw Error(fmt::format(
        "{}: one file holds one bed, and {} strokes at {} a bed need several; name a folder",
        request.out.string(), request.strokes, request.sequence));
  if (request.out.extension() != ".h5") std::filesystem::create_directories(request.out);
  return Collector(config, request, stop).Run();
}

}  // namespace sandwright
