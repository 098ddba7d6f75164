// Recorded strokes as the surrogate's training samples.
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "env/surrogate.h"
#include "env/surrogate_encoding.h"

namespace sandwright {

// One stroke: what the net sees and what it should say, in units of kResidualScale_m.
struct FitSample {
  std::string name;  // file and stroke, for messages
  SurrogateInput input;
  std::vector<float> target;  // [rows, columns] truth less the heightfield's prediction
  std::vector<float> weight;  // [rows, columns] 1 = counts, 0 = padded or not seen by the camera
};

struct FitSamples {
  std::vector<FitSample> samples;
  std::set<std::string> beds;
  std::map<std::string, std::string> sha256;  // of each file, by its name
};

// Reads stroke files, brings the maps to the model's cells and runs its heightfield on each stroke.
// Error: no stroke, another blade than the model's, cells that do not divide a map.
FitSamples ReadFitSamples(const std::vector<std::filesystem::path>& files,
                          const SurrogateConfig& model, int threads);

// A copy under symmetry 0..7 of the square: bit 0 mirrors x, bit 1 mirrors y, bit 2 swaps x and y
// (after the mirrors). 0 changes nothing.
FitSample ApplySymmetry(const FitSample& sample, int symmetry);

}  // namespace sandwright
