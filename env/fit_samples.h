// Recorded strokes as the surrogate's training samples.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "data/stroke_dataset.h"
#include "env/surrogate.h"
#include "env/surrogate_encoding.h"

namespace sandwright {

struct FitStroke {
  std::string name;     // file and stroke, for messages
  StrokeRecord record;  // on its own cells
  size_t behind = 0;    // strokes of the same sequence that lie right before it in the list
};

struct FitStrokes {
  std::vector<FitStroke> strokes;
  std::set<std::string> beds;
  std::map<std::string, std::string> sha256;  // of each file, by its name (with folders, where two are alike)
};

// Error: no stroke, another blade than the model's, a map that cells of `cell_size_m` do not divide.
FitStrokes ReadFitStrokes(const std::vector<std::filesystem::path>& files, const Blade& blade,
                          std::optional<double> cell_size_m = {});

// Error where a bed is in both: splits go by bed, never by stroke.
void CheckSplit(const FitStrokes& data, const FitStrokes& validation);
// What a model was trained on and chosen by, for its metadata: strokes, beds and hashes of the files;
// under `init` the same of the model that it started from.
nlohmann::json SplitIdentity(const FitStrokes& data, const FitStrokes& validation,
                             const std::optional<std::filesystem::path>& init = {});

// "1.234 mm", for the notes of a fit.
std::string Millimetres(double value_mm);
// "validation ..., best ..., at first ...".
std::string ValidationNote(double rmse_mm, double best_mm, double start_mm);

// How a bed is laid under the model's grid: turned about its middle, then shifted.
struct Placement {
  double turn_rad = 0, shift_x_m = 0, shift_y_m = 0;
};

// The map on cells of another size under `placement`, the walls where they were: means over points
// as dense as the map's cells. Cells that then lie beyond the bed hold the nearest height and are
// marked as not seen. Without turn and shift it is Resample.
HeightMap Place(const HeightMap& map, const Placement& placement, double cell_size_m);
// A path on that bed.
ToolPath Place(const ToolPath& path, const Placement& placement, const HeightMap& map);

// One stroke: what the net sees and what it should say, in units of kResidualScale_m.
struct FitSample {
  std::string name;
  HeightMap start;  // what the net's change is added to
  SurrogateInput input;
  std::vector<float> target;  // [rows, columns] truth less `start`
  std::vector<float> weight;  // [rows, columns] 1 = counts, 0 = padded or not seen by the camera
};

// `before` and `truth` are on the model's cells. Runs the model's heightfield where it has one. Error
// where the path lies outside the box.
FitSample MakeFitSample(const std::string& name, const HeightMap& before, const HeightMap& truth,
                        const ToolPath& path, const SurrogateConfig& model);

// A copy under symmetry 0..7 of the square: bit 0 mirrors x, bit 1 mirrors y, bit 2 swaps x and y
// (after the mirrors). 0 changes nothing. `start` stays as it was.
FitSample ApplySymmetry(const FitSample& sample, int symmetry);

}  // namespace sandwright
