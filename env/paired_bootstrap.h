// Whether one model is better than another on the same strokes, or only luckier.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "env/score.h"

namespace sandwright {

// Strokes of a bed follow each other, so whole beds are drawn where there are at least this many.
inline constexpr int kFewestBedsToResample = 4;

struct PairedComparison {
  double explained = 0, explained_against = 0;  // over the strokes that both have
  double difference = 0;                        // explained - explained_against
  double low95 = 0, high95 = 0;                 // of the difference
  double better_share = 0;                      // of the resamples in which it is above 0
  std::string unit;                             // what was drawn: "beds" or "strokes"
  int units = 0;
  int strokes = 0;
  int resamples = 0;              // in which both figures are defined
  nlohmann::json ToJson() const;  // the fields by their names
};

// Percentile bootstrap (Efron and Tibshirani, "An Introduction to the Bootstrap", 1993, chapter 13)
// of the difference in `explained` between two models scored on the same files: units are drawn
// with replacement, the same ones for both. The same seed gives the same figures. Error where no stroke
// is in both, or nothing changed by more than the floor.
PairedComparison CompareExplained(std::span<const StrokeScore> strokes,
                                  std::span<const StrokeScore> against, double floor_mm,
                                  uint64_t seed, int resamples = 10000);

}  // namespace sandwright
