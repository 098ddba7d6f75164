// Random natural terrains for tasks, collected strokes and training.
#pragma once

#include "data/base/config.h"
#include "data/base/random.h"
#include "data/height_map.h"

namespace sandwright {

struct TerrainConfig {
  double mean_depth_m = 0.05;
  double amplitude_m = 0.008;
  double longest_m = 0.15;
  int64_t scales = 3;
  double persistence = 0.5;
  int64_t shapes = 0;
  double shape_height_m = 0.02;
  double tilt_deg = 0;
  double repose_deg = 33;
  int64_t strokes = 0;

  void Fields(FieldList& f) {
    f.Add("mean_depth_m", mean_depth_m, "mean depth of the sand [m]", 0.005, 1);
    f.Add("amplitude_m", amplitude_m,
          "standard deviation of the heights before they settle [m]; 0: flat", 0, 0.5);
    f.Add("longest_m", longest_m, "size of the largest hills [m]", 0.01, 5);
    f.Add("scales", scales, "number of scales, each half the one before", 1, 8);
    f.Add("persistence", persistence, "amplitude of a scale over that of the one before [1]", 0, 1);
    f.Add("shapes", shapes, "mounds, craters, trenches and ridges at random places", 0, 100);
    f.Add("shape_height_m", shape_height_m, "height or depth of the largest shape [m]", 0, 0.5);
    f.Add("tilt_deg", tilt_deg, "the whole bed slopes by up to this, in any direction [deg]", 0, 30);
    f.Add("repose_deg", repose_deg, "no slope is steeper [deg]", 5, 60);
    f.Add("strokes", strokes,
          "strokes of the excavation routine through it, by the heightfield: a worked bed", 0, 1000);
  }
};

// Smooth noise at several scales, shapes and a slope, settled to repose, then worked by strokes
// (data/excavation.h). The mean depth is exact to rounding; before the strokes no cell is below a fifth of
// it (the amplitude gives way). Same stream, same bytes. Throws Error where a value is out of range, the
// grid has less than 1 x 2 cells or leaves no room for a stroke.
HeightMap GenerateTerrain(const TerrainConfig& config, int rows, int columns, double cell_size_m,
                          RandomStream& stream);

}  // namespace sandwright
