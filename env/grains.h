// A bed of grains: spheres in a box, and the surface that a camera above them sees.
#pragma once

#include <string>
#include <vector>

#include "data/base/hdf5.h"
#include "data/height_map.h"

namespace sandwright {

// A sphere in frame B of the box.
struct Grain {
  double x_m, y_m, z_m, radius_m;
};

// Grains at rest between the walls of a box, over its floor.
struct GrainBed {
  double width_m = 0, depth_m = 0;  // along x, along y
  std::vector<Grain> grains;
};

// Highest sphere surface over each cell's centre (0, the floor, where there is none), blurred by a
// Gaussian of `blur_m` as a camera's pixels do. The cell size is the box's width over `columns`.
HeightMap SurfaceOf(const GrainBed& bed, int rows, int columns, double blur_m);

// Grains in a file: dataset grains_m [n, 4] float64 of x, y, z, radius.
std::vector<Grain> ReadGrains(const H5::H5File& file, const std::string& where);
void WriteGrains(const std::vector<Grain>& grains, H5::H5File& file);

}  // namespace sandwright
