// Goals that a blade can reach: simple shapes with slopes within
// repose, of the terrain's own volume.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "data/height_map.h"
#include "env/action.h"

namespace sandwright {

enum class GoalKind { kLevel, kMound, kCrater, kTrench, kRidge, kTerrace };
inline constexpr std::array<std::string_view, 6> kGoalNames = {"level",  "mound", "crater",
                                                               "trench", "ridge", "terrace"};

// Throws Error that lists the kinds.
GoalKind ParseGoalKind(const std::string& name);

// A shape on a plane; which numbers count depends on the kind.
struct GoalShape {
  GoalKind kind = GoalKind::kLevel;
  double x_m = 0, y_m = 0;   // middle, in frame B
  double heading_rad = 0;    // along trench and ridge; terrace: uphill
  double half_length_m = 0;  // trench, ridge: half the straight middle line
  double half_width_m = 0;   // half the flat top or bottom
  double rise_m = 0;         // top above (bottom below) the plane; terrace: between its levels
  double slope = 0.45;       // rise over run of the flanks; 0.45: 24 degrees
};

// Height of the shape against its plane [m] at a point of frame B.
double ShapeHeight(const GoalShape& shape, double x_m, double y_m);
// Distance of a point to the outer foot of the shape [m], negative inside; level and terrace: -1.
double DistanceToFoot(const GoalShape& shape, double x_m, double y_m);

// The goal on the terrain's grid: shape plus the one plane height that gives the goal the terrain's
// volume over the mask, so that it can be reached by moving sand within it. The mask is the part of
// `region` within `margin_m` of the shape's foot. Throws Error where the mask would be empty or the
// goal lower than the floor.
HeightMap MakeGoal(const GoalShape& shape, const HeightMap& terrain, const Region& region,
                   double margin_m);

// `wish` (same grid, mask filled and not empty, heights relative) as a goal: where it counts, on the one
// plane that gives it the terrain's volume; elsewhere as the terrain. `name` goes into the Error where
// it is lower than the floor.
HeightMap BalanceGoal(const HeightMap& wish, const HeightMap& terrain, const std::string& name);

}  // namespace sandwright
