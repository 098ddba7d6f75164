// Collects strokes from a sand model: the excavation routine, unattended, before and after kept.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "data/base/run_status.h"
#include "data/base/stop.h"
#include "data/excavation.h"
#include "env/dem_config.h"
#include "env/heightfield.h"
#include "env/terrain_generator.h"

namespace sandwright {

struct CollectConfig {
  double width_m = 0.3;
  double depth_m = 0.3;
  double cell_size_m = 0.005;
  int64_t packings = 1;
  TerrainConfig terrain;
  ExcavationConfig excavation;
  HeightfieldConfig heightfield;
  DemConfig dem;

  void Fields(FieldList& f) {
    f.Add("width_m", width_m, "box along x [m]", 0.02, 10);
    f.Add("depth_m", depth_m, "box along y [m]", 0.02, 10);
    f.Add("cell_size_m", cell_size_m, "cell of the height maps [m]", 0.0005, 0.1);
    f.Add("packings", packings,
          "grains only: each stroke on so many beds of the same terrain, their grains packed anew "
          "(replicates, for the noise floor); 1: strokes follow each other on one bed", 1, 100);
    f.Section("terrain", terrain);
    f.Section("excavation", excavation);
    f.Section("heightfield", heightfield);
    f.Section("dem", dem);
  }
};

struct CollectRequest {
  std::filesystem::path out;  // a folder (one file a bed: bed_NNNNN.h5) or one .h5 file (one bed)
  int64_t strokes = 0;        // in all
  int64_t sequence = 0;       // strokes a bed
  uint64_t seed = 0;
  int threads = 1;            // beds at a time; grains: processes
  std::string source = "heightfield";  // or "dem"
  RunStatus* status = nullptr;         // told how it goes; none: nobody watches
};

// Strokes on file, and how many of them this call added.
struct Collected {
  int64_t strokes = 0, added = 0;
};

// Continues what exists under `out` and writes each bed's file whole after each stroke; a bed of
// grains that is not finished keeps its grains beside it in a hidden file. Stops early
// when `stop` says so; a later call then goes on, to the same bytes as a call that was never
// stopped. Throws Error where existing files come from other settings, or the request is no plan.
Collected Collect(const CollectConfig& config, const CollectRequest& request,
                  const std::function<bool()>& stop = StopRequested);

}  // namespace sandwright
