// How training goes over several seeds: the interquartile mean with its bootstrap interval (Agarwal et
// al., "Deep reinforcement learning at the edge of the statistical precipice", NeurIPS 2021).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "data/base/random.h"

namespace sandwright {

struct LearningCurve {
  int runs = 0;
  std::vector<double> steps, iqm, low95, high95;  // of equal length
};

// The mean of the middle half; a value that the quarter's edge cuts counts by its part. `values` is not
// empty.
double InterquartileMean(std::vector<double> values);

struct Spread {
  double iqm = 0, low95 = 0, high95 = 0;
};
// Of one value a seed: the interquartile mean, and the percentile bootstrap's interval of it over seeds
// (one seed: the value itself). `values` is not empty.
Spread SpreadOf(const std::vector<double>& values, RandomStream& stream);

// `column` of the progress.csv of each run folder, at the steps where all runs have it. The same seed
// gives the same figures.
// Throws Error naming the folder or column where there is no such file or column, or no common step.
LearningCurve ReadLearningCurve(std::span<const std::filesystem::path> run_folders,
                                const std::string& column, uint64_t seed);

}  // namespace sandwright
