// Triangle meshes and clouds of points, and the way between them and height maps.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "data/height_map.h"

namespace sandwright {

struct Mesh {
  std::vector<Eigen::Vector3d> points;             // in the unit of whoever made it
  std::vector<std::array<uint32_t, 3>> triangles;  // indices into `points`; none: a cloud of points
};

// The surface of a map [m]: a point at each cell's centre, two triangles between four of them. Cells
// whose height is NaN are left out, and so are triangles at them. Error naming `source` where no cell is left.
Mesh MeshOf(const HeightMap& map, const std::string& source);

// The heights of a mesh seen from above (the highest surface counts) on cells of `cell_size_m`; the first
// cell's centre has the smallest x and y of all points. A cloud must be a grid of that size, or becomes one by
// GridPoints. NaN where there is nothing. Datum relative. Error naming `source` where the extent makes fewer than
// two or more than 16 million cells (is the unit right?) or none is covered. The mesh has points, all finite.
HeightMap HeightsOf(const Mesh& mesh_m, double cell_size_m, const std::string& source);

// The same on a grid that is given: the map's cells are filled, its first cell's corner at (x_m, y_m) of
// the mesh. A mesh of triangles is needed.
void FillFromAbove(const Mesh& mesh_m, double x_m, double y_m, HeightMap& map);

// Smallest and largest coordinates of all points; the mesh has some.
std::array<Eigen::Vector3d, 2> Bounds(const Mesh& mesh);

}  // namespace sandwright
