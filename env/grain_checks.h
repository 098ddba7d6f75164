// Do the grains behave as sand? Figures of scenes with a known answer: the rows of
// `bench --suite grains`.
#pragma once

#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "env/dem_config.h"

namespace sandwright {

// One figure that a scene gave, and the range that it should lie in.
struct GrainCheck {
  std::string name, unit;
  double measured = 0;
  double low = -std::numeric_limits<double>::infinity();  // infinite: no limit on that side
  double high = std::numeric_limits<double>::infinity();
  std::string source = {};  // of the range

  bool limited() const { return low > -std::numeric_limits<double>::infinity(); }
  bool holds() const { return measured >= low && measured <= high; }
  // The fields by their names, and `holds`; without a range only the first three.
  nlohmann::json ToJson() const;
};

// The checks of grain_slopes.h and grain_strokes.h at the sizes of docs/sand.md. Each figure is given
// to `done` with the seconds that its scene took (0 for further ones of a scene). Ctrl-C throws
// kInterrupted.
void RunGrainChecks(const DemConfig& config,
                    const std::function<void(const GrainCheck&, double seconds)>& done);

}  // namespace sandwright
