// Heightfield strokes in the place of recorded ones, made anew in each pass over a training.
#pragma once

#include "env/fit_samples.h"
#include "env/heightfield_strokes.h"

namespace sandwright {

struct GeneratedStrokes {
  int64_t strokes = 500;
  int64_t sequence = 4;
  HeightfieldStrokesConfig drawn;

  void Fields(FieldList& f) {
    f.Add("strokes", strokes, "new ones in each pass over the training", 1, 1000000);
    f.Add("sequence", sequence, "of them in a row on one bed", 1, 1000);
    drawn.Fields(f);
  }
};

// Pass `epoch` of them on cells of `cell_size_m`, the same for the same seed on any number of
// threads. Error where the cells do not divide the bed.
FitStrokes GenerateStrokes(const GeneratedStrokes& config, double cell_size_m, uint64_t seed,
                           int epoch);

}  // namespace sandwright
