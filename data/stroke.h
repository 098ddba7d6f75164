// A stroke of the blade and the tool path it traces.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "data/base/config.h"

namespace sandwright {

// The blade stands across the path, its normal along the direction of travel.
struct Blade {
  double width_m = 0.050;      // across the path
  double thickness_m = 0.005;  // along the path

  void Fields(FieldList& f) {
    f.Add("width_m", width_m, "blade width across the path [m]", 0.005, 0.5);
    f.Add("thickness_m", thickness_m, "blade thickness along the path [m]", 0.0005, 0.05);
  }
};

// 2-4 control points of the blade's lower edge (its middle) in frame B. The blade enters and leaves
// vertically at the ends.
struct Stroke {
  std::vector<Eigen::Vector3d> control_points_m;  // n = 2..4
  int degree = 1;                                 // 1: polyline; 2: one Bezier curve of order n - 1
  double speed_mps = 0.1;
};

// One pose of the blade: lower edge, middle, in frame B; yaw is the heading of the blade's normal,
// continuous along a path (it may pass pi).
struct BladePose {
  double x_m = 0, y_m = 0, z_m = 0, yaw_rad = 0;
};

// A sampled stroke. At a polyline's corner the blade stops and turns on the spot: poses with equal
// position and turning yaw.
using ToolPath = std::vector<BladePose>;

// Throws Error with what is wrong: 2-4 points, finite, degree 1 or 2, positive speed, neighbouring
// points of a polyline at least 1 mm apart in the plane, no Bezier cusp. Does not look at any box.
void CheckStroke(const Stroke& stroke, const std::string& source);

// Poses at most `step_m` apart along the path and, while turning, `turn_step_rad` apart.
ToolPath SamplePath(const Stroke& stroke, double step_m, double turn_step_rad = 0.1);

// Length of the path in the plane [m].
double PathLength(const Stroke& stroke);

// The class A..F of Deep Sandscapes, figure 4 (flat: z varies by less than 1 mm): A flat line, B
// flat polyline, C polyline with height variation and up to 3 points, D flat curve, E polyline with
// height variation and 4 points, F curve with height variation.
char ComplexityClass(const Stroke& stroke);

// A list of strokes in a YAML file: the `strokes` part of a plan (schema "sandwright-plan", version
// 1), where each has control_points_m, degree and speed_mps. `frame` must be `box`.
std::vector<Stroke> ReadStrokes(const std::filesystem::path& file);

}  // namespace sandwright
