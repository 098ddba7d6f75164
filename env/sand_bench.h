// Speed and error of the sand models, measured side by side: the rows of `bench --suite sand`.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "env/dem_config.h"
#include "env/heightfield.h"

namespace sandwright {

struct SandBenchRow {
  std::string name;
  int threads = 1, batch = 1;
  double cell_size_m = 0;
  double ms_per_stroke = 0;  // best of several runs, wall clock; an exact case: all of it
  std::optional<double> rmse_mm = {}, mae_mm = {};              // where there is a truth
  std::optional<double> rmse_cells = {}, max_cells = {};        // of exact cases
  std::optional<double> r2_change = {}, volume_drift_rel = {};  // of recorded strokes
  int strokes_failed = 0;                                       // of those: ScoreReport

  nlohmann::json ToJson() const;  // the fields that there are, by their names
};

struct SandBench {
  HeightfieldConfig heightfield;
  DemConfig dem;
  int threads = 1;
  std::vector<std::filesystem::path> data;       // stroke files; empty: no errors on strokes
  std::vector<std::string> models = {"default"};  // scored on them, as LoadSandModel takes them
};

// Exact cases; a stroke of 200 mm by cell size and by size of the box; a batch by threads; and, on
// recorded strokes, nothing changes, heightfield by cell size and `models`. Each row is
// given to `done` as it comes. Ctrl-C throws kInterrupted.
void RunSandBench(const SandBench& bench, const std::function<void(const SandBenchRow&)>& done);

// Recorded strokes through coarse grains of 10 and 8 mm, one packing each (LAMMPS, up to a minute
// a stroke). Nothing without data.
void RunGrainSizes(const SandBench& bench, const std::function<void(const SandBenchRow&)>& done);

}  // namespace sandwright
