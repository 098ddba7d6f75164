// Random strokes on random beds, and what of a sound bed of sand they ever broke: the hard case of
// everything that a policy may try.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>

#include "env/heightfield.h"

namespace sandwright {

// The worst of all strokes so far.
struct RandomStrokeTally {
  int64_t strokes = 0, limited = 0;  // limited: left the box or went below the floor
  int64_t not_finite = 0;            // strokes after which a height was no number
  double lowest_m = 1e9;             // height
  double steepest = 0;               // slope at rest over that at the angle of repose
  double volume_drift_rel = 0;       // change of a stroke, over the volume of its bed
  double ms_per_stroke = 0;
  bool sound() const {
    return not_finite == 0 && lowest_m >= 0 && steepest <= kSteepest && volume_drift_rel <= 1e-6;
  }
  // Untouched sand holds 0.5 % more than loose sand, and rest is reached to 0.1 %.
  static constexpr double kSteepest = 1.0065;
  nlohmann::json ToJson() const;
};

// Beds of 0.4 m with hills on cells of 2.5 to 20 mm, 50 strokes on each, down to the floor; a tenth of them
// shifted through a wall or through the floor. The same seed gives the same strokes for any number of
// threads. `progress` gets the tally after each round of beds. Ctrl-C throws kInterrupted.
RandomStrokeTally RunRandomStrokes(const HeightfieldConfig& config, int64_t strokes, uint64_t seed,
                                   int threads,
                                   const std::function<void(const RandomStrokeTally&)>& progress);

// Steepest slope at any face [rise over run]: the difference across it, and the mean of the four one-sided
// differences beside it; walls are level.
double SteepestFace(const HeightMap& map);

}  // namespace sandwright
