#include "env/dem_bed.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "data/base/error.h"
#include "data/base/hdf5.h"
#include "data/base/random.h"
#include "data/base/sha256.h"

namespace sandwright {
namespace {

constexpr uint64_t kFill = StreamId("dem fill");
constexpr int64_t kBedSchemaVersion = 1;

std::filesystem::path CacheFolder(const DemConfig& config) {
  if (!config.cache.empty()) return config.cache;
  if (const char* folder = std::getenv("XDG_CACHE_HOME"); folder && *folder)
    return std::filesystem::path(folder) / "sandwright";
  if (const char* home = std::getenv("HOME"); home && *home)
    return std::filesystem::path(home) / ".cache" / "sandwright";
  throw Error("no place for settled beds: neither dem.cache, XDG_CACHE_HOME nor HOME is set");
}

// Grains on a loose lattice over the whole box, with random diameters and velocities.
DemScene Lattice(const GrainMaterial& material, double width_m, double depth_m, double sand_depth_m,
                 uint64_t seed) {
  constexpr double kSpacing = 1.22;      // [diameters]
  constexpr double kLayerAtRest = 0.55;  // depth of sand that one layer gives [diameters]
  constexpr double kSpeed_mps = 0.1;
  DemScene scene{{0, 0}, {width_m, depth_m}, {true, true}, {true, true}, {}, {}, {}};
  const double pitch = kSpacing * material.grain_m;
  const auto count = [](double extent, double step) {
    return std::max(1, static_cast<int>(extent / step));
  };
  const int columns = count(width_m, pitch), rows = count(depth_m, pitch);
  const int layers = static_cast<int>(std::ceil(sand_depth_m / (kLayerAtRest * material.grain_m)));
  RandomStream stream(seed, kFill);
  for (int layer = 0; layer < layers; ++layer) {
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        const double radius_m = material.grain_m / 2 *
                                (1 + stream.Uniform(-material.grain_spread, material.grain_spread));
        scene.grains.push_back({(column + 0.5) * width_m / columns, (row + 0.5) * depth_m / rows,
                                (layer + 0.5) * pitch, radius_m});
        const double vx = stream.Uniform(-kSpeed_mps, kSpeed_mps),
                     vy = stream.Uniform(-kSpeed_mps, kSpeed_mps);
        scene.velocity_mps.emplace_back(vx, vy, stream.Uniform(-kSpeed_mps, kSpeed_mps));
      }
    }
  }
  scene.held.assign(scene.grains.size(), 0);
  return scene;
}

void CheckReport(const DemReport& report, const char* what) {
  if (report.grains_lost > 0)
    throw Error(fmt::format("{} grains of {} left the box while {}", report.grains_lost,
                            report.grains_moving, what),
                ErrorKind::kInternal);
}

}  // namespace

GrainBed SettledBed(const DemConfig& config, double box_width_m, double box_depth_m,
                    double sand_depth_m, uint64_t seed, const std::function<bool()>& stop) {
  GrainMaterial material = config.material;
  const std::string key =
      fmt::format("{} {:.6f} {:.6f} {:.6f} {}", ToJson(FieldsOf(material)).dump(), box_width_m,
                  box_depth_m, sand_depth_m, seed);
  const std::filesystem::path folder = CacheFolder(config);
  const std::filesystem::path file = folder / ("bed_" + Sha256Hex(key).substr(0, 16) + ".h5");
  GrainBed bed{box_width_m, box_depth_m, {}};
  if (std::filesystem::exists(file)) {
    const H5::H5File h5 = OpenHdf5(file);
    CheckSchema(h5, file.string(), "sandwright-grains", kBedSchemaVersion);
    bed.grains = ReadGrains(h5, file.string());
    return bed;
  }
  DemScene scene = Lattice(config.material, box_width_m, box_depth_m, sand_depth_m, seed);
  spdlog::info("settling {} grains of {:g} mm, once for this box, depth and seed",
               scene.grains.size(), config.material.grain_m * 1e3);
  const DemReport report = SettleGrains(config, scene, stop);
  CheckReport(report, "a bed settled");
  bed.grains = std::move(scene.grains);
  std::filesystem::create_directories(folder);
  WriteHdf5(file, [&](H5::H5File& h5) {
    WriteSchema(h5, "sandwright-grains", kBedSchemaVersion);
    WriteText(h5, "made_with", key);
    WriteGrains(bed.grains, h5);
  });
  return bed;
}

GrainBed CarvedBed(const DemConfig& config, const HeightMap& terrain, uint64_t seed,
                   const std::function<bool()>& stop) {
  if (terrain.datum != Datum::kFloor)
    throw Error(
        "sand model 'dem' (grains) needs heights above the floor; this terrain's datum is "
        "relative");
  constexpr double kDepthStep_m = 0.02;  // so that similar terrains share one settled bed
  const double highest_m = *std::ranges::max_element(terrain.height_m);
  const double depth_m =
      std::ceil((highest_m + 2 * config.material.grain_m) / kDepthStep_m) * kDepthStep_m;
  const GrainBed full =
      SettledBed(config, terrain.width_m(), terrain.depth_m(), depth_m, seed, stop);

  const auto carve = [&](double offset_m) {
    GrainBed bed{full.width_m, full.depth_m, {}};
    for (const Grain& g : full.grains) {
      if (g.z_m <= HeightAt(terrain, g.x_m, g.y_m) + offset_m) bed.grains.push_back(g);
    }
    return bed;
  };
  const auto mean_height = [](const HeightMap& map) {
    return std::accumulate(map.height_m.begin(), map.height_m.end(), 0.0) /
           static_cast<double>(map.size());
  };
  const double wanted_m = mean_height(terrain);
  double low_m = -2 * config.material.grain_m, high_m = 2 * config.material.grain_m;
  for (int i = 0; i < 20; ++i) {
    const double middle_m = (low_m + high_m) / 2;
    const HeightMap surface =
        SurfaceOf(carve(middle_m), terrain.rows, terrain.columns, config.blur_m);
    (mean_height(surface) < wanted_m ? low_m : high_m) = middle_m;
  }
  GrainBed bed = carve((low_m + high_m) / 2);
  DemScene scene{
      {0, 0}, {bed.width_m, bed.depth_m}, {true, true}, {true, true}, std::move(bed.grains), {},
      {}};
  scene.held.assign(scene.grains.size(), 0);
  CheckReport(RunGrains(config, {}, scene, stop), "a carved bed came to rest");
  bed.grains = std::move(scene.grains);
  return bed;
}

}  // namespace sandwright
