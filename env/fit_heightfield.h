// Calibrates the heightfield's parameters on recorded strokes.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "env/heightfield.h"

namespace sandwright {

struct CalibrationConfig {
  std::vector<double> cell_sizes_m = {0.01, 0.005, 0.0025};
  std::vector<std::string> parameters = {"loose_deg", "relaxation_m", "cut.rupture_ratio",
                                         "cut.spread", "cut.bite_m"};
  double first_step = 0.3;
  double last_step = 0.02;
  HeightfieldConfig heightfield;  // where the search starts

  void Fields(FieldList& f) {
    f.Add("cell_sizes_m", cell_sizes_m, "grids that one set of parameters must serve [m]", 0.0005,
          0.1);
    f.Add("parameters", parameters, "keys of the heightfield that are fitted");
    f.Add("first_step", first_step, "share by which a parameter is changed at first", 0.001, 2);
    f.Add("last_step", last_step, "share at which the search ends", 0.0001, 1);
    f.Section("heightfield", heightfield);
  }
};

// Mean over the grids, errors on the grids' own cells.
struct CalibrationScore {
  double r2_change = 0, rmse_mm = 0, mae_mm = 0;
};

struct Calibration {
  HeightfieldConfig heightfield;
  CalibrationScore start, fitted;              // on the strokes that were fitted
  std::optional<CalibrationScore> validation;  // on other beds
  int evaluations = 0;
  nlohmann::json ToJson() const;
};

// Coordinate search for the greatest mean r2_change: each parameter is changed by a share up and down in
// turn, what improves is kept, and the share is halved where nothing does. Deterministic. `progress` gets
// the evaluations done and the best r2_change. Throws Error for a key that is no number of the
// heightfield's, or a bed in both sets; Ctrl-C throws kInterrupted.
Calibration CalibrateHeightfield(const CalibrationConfig& config,
                                 const std::vector<std::filesystem::path>& data,
                                 const std::vector<std::filesystem::path>& validation, int threads,
                                 const std::function<void(int, double)>& progress);

}  // namespace sandwright
