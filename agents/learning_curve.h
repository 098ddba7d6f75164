// How training goes over several seeds: the interquartile mean with its bootstrap interval (Agarwal et
// al., "Deep reinforcement learning at the edge of the statistical precipice", NeurIPS 2021).
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sandwright {

struct LearningCurve {
  int runs = 0;
  std::vector<double> steps, iqm, low95, high95;  // of equal length
};

// The mean of the middle half; a value that the quarter's edge cuts counts by its part. `values` is not
// empty.
double InterquartileMean(std::vector<double> values);

// `column` of the progress.csv of each run folder, at the steps where all runs have it. The interval is
// the percentile bootstrap over runs (one run: the value itself). The same seed gives the same figures.
// Throws Error naming the folder or column where there is no such file or column, or no common step.
LearningCurve ReadLearningCurve(std::span<const std::filesystem::path> run_folders,
                                const std::string& column, uint64_t seed);

}  // namespace sandwright
