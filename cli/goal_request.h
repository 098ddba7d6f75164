// A goal from what a designer has, laid onto a terrain.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "env/goal_wish.h"

namespace sandwright {

struct GoalRequest {
  std::string image, mesh, svg, scan, shape;  // one of them
  std::vector<double> range_mm;               // image: heights of black and of white
  std::string unit;                           // mesh, svg: mm or m
  std::string up = "z";                       // mesh: the axis that points up
  std::optional<double> depth_mm;             // svg: of what names none
  double rise_mm = 15, flat_mm = 60, length_mm = 100;  // shape
  std::vector<double> at_m;                   // middle in B
  std::optional<double> size_m;               // width at its place, before it turns
  double turn_deg = 0;
  std::string zero;                           // "sand" or "floor"; empty: by the source
  double lift_mm = 0;
};

// Error naming the flag or file that is missing, not allowed or cannot be read.
Wish MakeWish(const GoalRequest& request, const HeightMap& terrain);

}  // namespace sandwright
