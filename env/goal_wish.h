// A shape from elsewhere (a picture, a mesh, a drawing, a scan) laid onto the sand as a goal.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "data/height_map.h"

namespace sandwright {

// Where and how it lies. The shape turns about its own middle.
struct WishPlace {
  std::optional<Eigen::Vector2d> at_m = {};  // its middle in B; not given: the middle of the box
  double scale = 1;                          // in the plane
  double turn_rad = 0;                       // counter-clockwise, seen from above
  double height_scale = 1;
  double zero_m = 0;  // height of the shape's zero in B
};

struct Wish {
  HeightMap goal;     // on the terrain's grid; outside its mask as the terrain
  double cut_share;   // of the shape that lies beyond the walls
};

// Each cell is the mean of 4 x 4 places in it, and counts where half of them lie on the shape (cells that are
// not NaN). On the terrain's own grid and as it is, a shape is taken over cell by cell. Error naming `name` where
// the shape is larger than the box three times over (a wrong unit), or no two cells count.
Wish PlaceWish(const HeightMap& shape, const WishPlace& place, const HeightMap& terrain, const std::string& name);

// Error as above for an extent [m] that is about to be placed.
void CheckWishExtent(double width_m, double depth_m, const HeightMap& terrain, const std::string& name);

// Mean height of the cells of `map` that are not NaN and, where it has a mask, count [m].
double MeanCounted(const HeightMap& map);

}  // namespace sandwright
