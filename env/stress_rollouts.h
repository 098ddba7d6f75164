// Rollouts of a sand model on beds and under strokes as bad as a policy can make them, and what of
// sound sand they broke: the rows of `bench --suite surrogate`.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "env/rollout_score.h"
#include "env/sand_model.h"

namespace sandwright {

struct StressConfig {
  int64_t strokes = 1000;         // of all rollouts together, in whole rollouts
  int strokes_per_rollout = 100;  // each from what the model made of the one before
  double repose_deg = 33;         // of the sand, for slopes and for the highest that it can stand
  uint64_t seed = 0;
  int threads = 1;
};

// The worst over the rollouts on one kind of bed.
struct StressTally {
  std::string bed;
  int64_t rollouts = 0, strokes = 0;
  int64_t limited = 0;          // left the box or went below the floor
  int64_t not_finite = 0;       // strokes after which a height was no number
  int64_t below_floor = 0;      // strokes after which a height was negative
  int64_t too_high = 0;         // strokes after which sand stood higher than HighestPossible
  double stroke_drift_rel = 0;  // largest |change of the volume| in a stroke, over the bed's volume
  double rollout_drift_rel = 0;            // the same over a rollout
  double steepest = 0;                     // slope over that at repose, after any stroke
  double slope_first = 0, slope_last = 0;  // mean of the steepest after the first and last stroke
  double ms_per_stroke = 0;

  // The volume is not among it: not every model promises it.
  bool sound() const { return not_finite == 0 && below_floor == 0 && too_high == 0; }
  nlohmann::json ToJson() const;
};

// The kinds of beds, 300 x 300 mm: hills; a cliff of 100 mm; a flat film of 4 mm on the floor; flat
// and 20 mm deep; ridges one cell wide; piles at walls and in a corner; bare floor beside deep sand.
std::span<const std::string_view> StressBeds();

// Strokes are random, down to the floor and up to 60 mm deep; a third is moved across walls, corners
// and the floor. Rollouts go round the kinds of beds. The same seed gives the same figures, times
// apart, for any number of threads. `done` gets the strokes so far. Error where a model works on no
// cells that divide 300 mm; Ctrl-C throws kInterrupted.
std::vector<StressTally> RunStressRollouts(const SandModel& model, const StressConfig& config,
                                           const std::function<void(int64_t)>& done);

// The highest that a stroke can heap sand up [m]: what it moves, as a quarter of a cone at repose in a
// corner of the box on top of the highest sand before. All that stands above that height is a body of
// at most the moved volume whose slopes are at most at repose.
double HighestPossible(double highest_before_m, double moved_volume_m3, double repose_deg);

// `strokes` random strokes on a hilly bed of 1200 x 800 mm by `model` and by `truth`, each going on
// from its own bed: how far they come apart.
struct BoxDrift {
  RolloutScore difference;
  double volume_drift_rel = 0;  // of the model, at the end
  double ms_per_stroke = 0;     // of the model
};
BoxDrift RunBoxDrift(const SandModel& model, const SandModel& truth, int strokes, uint64_t seed);

}  // namespace sandwright
