// Where a scan takes the box from: its stated size, or the workcell and the arm's joints.
#pragma once

#include <string>

#include "data/scan.h"

namespace sandwright {

// `box`: "1.2x0.8" (m) or "" (found, or the workcell's). `workcell` and `joints` (files, both or
// none): the camera's pose X_BC by the arm's kinematics; `joints` is YAML, `joints_rad: [six
// angles]`. Throws Error naming the flag or file, what it holds and what is allowed.
ScanPlace PlaceOfScan(const std::string& box, const std::string& workcell,
                      const std::string& joints, const std::optional<double>& sand_depth_m);

}  // namespace sandwright
