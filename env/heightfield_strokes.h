// Strokes through the heightfield on random terrains, made on the fly: as many as a training wants.
#pragma once

#include <vector>

#include "data/excavation.h"
#include "data/stroke_dataset.h"
#include "env/heightfield.h"
#include "env/terrain_generator.h"

namespace sandwright {

struct HeightfieldStrokesConfig {
  double width_m = 0.3;
  double depth_m = 0.3;
  TerrainConfig terrain{.amplitude_m = 0.006, .shapes = 2, .tilt_deg = 6};
  ExcavationConfig excavation;
  HeightfieldConfig heightfield;

  void Fields(FieldList& f) {
    f.Add("width_m", width_m, "box along x [m]", 0.02, 10);
    f.Add("depth_m", depth_m, "box along y [m]", 0.02, 10);
    f.Section("terrain", terrain);
    f.Section("excavation", excavation);
    f.Section("heightfield", heightfield);
  }
};

// `count` strokes of the excavation routine (data/excavation.h), one after another on a new terrain,
// and what the heightfield says comes of them. The same stream gives the same bytes. Error where the
// box is no whole number of cells or leaves no room for a stroke.
std::vector<StrokeRecord> DrawHeightfieldStrokes(const HeightfieldStrokesConfig& config,
                                                 double cell_size_m, int64_t count,
                                                 RandomStream& stream);

}  // namespace sandwright
