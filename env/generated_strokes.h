// Strokes for pretraining that cost next to nothing: random ones on random terrains, through a
// heightfield.
#pragma once

#include "data/excavation.h"
#include "env/fit_samples.h"
#include "env/heightfield.h"
#include "env/terrain_generator.h"

namespace sandwright {

struct GeneratedStrokes {
  int64_t strokes = 500;  // in one pass
  int64_t sequence = 4;   // of them in a row on one bed
  double width_m = 0.3, depth_m = 0.3;
  TerrainConfig terrain{.amplitude_m = 0.006, .shapes = 2, .tilt_deg = 6};
  ExcavationConfig excavation;
  HeightfieldConfig heightfield;

  void Fields(FieldList& f) {
    f.Add("strokes", strokes, "new ones in each pass over the training", 1, 1000000);
    f.Add("sequence", sequence, "of them in a row on one bed", 1, 1000);
    f.Add("width_m", width_m, "bed along x [m]", 0.05, 5);
    f.Add("depth_m", depth_m, "bed along y [m]", 0.05, 5);
    f.Section("terrain", terrain);
    f.Section("excavation", excavation);
    f.Section("heightfield", heightfield);
  }
};

// Pass `epoch` of them on cells of `cell_size_m`, the same for the same seed on any number of
// threads. Error where the cells do not divide the bed.
FitStrokes GenerateStrokes(const GeneratedStrokes& config, double cell_size_m, uint64_t seed,
                           int epoch);

}  // namespace sandwright
