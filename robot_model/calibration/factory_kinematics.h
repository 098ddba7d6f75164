// The factory calibration of an arm from a file.
#pragma once

#include <filesystem>
#include <string>

#include "robot_model/ur10.h"

namespace sandwright {

// From the controller's `calibration.conf` (ini: section [mounting] with delta_theta, delta_a,
// delta_d, delta_alpha, six numbers each, which are added to the nominal parameters), or from YAML
// (.yaml, .yml) with a_m, d_m, alpha_rad, theta_rad as a workcell's section `kinematics` has them.
// Throws Error naming the key for a list that is missing or not six finite numbers, for a joint
// calibration that the file itself calls unfinished, and for parameters that move the flange by
// more than CheckFactoryKinematics allows.
DhParameters ReadFactoryKinematics(const std::filesystem::path& file);

// No factory delivers a UR10 whose flange is further from the nominal one's.
inline constexpr double kMaxFactoryShift_m = 0.030;
// Throws Error with the figure where one is; `source` says whose parameters they are.
void CheckFactoryKinematics(const DhParameters& kinematics, const std::string& source);

// How far the flange moves from one set of parameters to the other, over random poses.
struct FlangeShift {
  double p50_m = 0, p95_m = 0, max_m = 0;
};
FlangeShift MeasureFlangeShift(const DhParameters& from, const DhParameters& to, int poses = 1000,
                               uint64_t seed = 1);

}  // namespace sandwright
