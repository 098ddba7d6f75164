// Strokes through the heightfield on random terrains, made one by one: as many as a training wants.
#pragma once

#include "data/excavation.h"
#include "data/stroke_dataset.h"
#include "env/heightfield.h"
#include "env/terrain_generator.h"

namespace sandwright {

struct HeightfieldStrokesConfig {
  double width_m = 0.3;
  double depth_m = 0.3;
  double cell_size_m = 0.004;
  TerrainConfig terrain;
  ExcavationConfig excavation;
  HeightfieldConfig heightfield;

  void Fields(FieldList& f) {
    f.Add("width_m", width_m, "box along x [m]", 0.02, 10);
    f.Add("depth_m", depth_m, "box along y [m]", 0.02, 10);
    f.Add("cell_size_m", cell_size_m, "cell of the height maps [m]", 0.0005, 0.1);
    f.Section("terrain", terrain);
    f.Section("excavation", excavation);
    f.Section("heightfield", heightfield);
  }
};

// A stroke of the excavation routine (data/excavation.h) on a terrain of its own, and what the
// heightfield says comes of it. The same stream gives the same bytes. Error where the box is no
// whole number of cells or leaves no room for a stroke.
StrokeRecord DrawHeightfieldStroke(const HeightfieldStrokesConfig& config, RandomStream stream);

}  // namespace sandwright
