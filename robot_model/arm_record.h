// What the arm did, at 125 Hz, and where the blade went.
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <functional>
#include <vector>

#include "data/stroke.h"
#include "robot_model/stroke_motion.h"

namespace sandwright {

// One entry a period in each list.
struct ArmRecord {
  std::vector<double> time_s;
  std::vector<JointAngles> commanded, measured;
  std::vector<Vector6> speed_radps;      // of the measured angles
  std::vector<Eigen::Vector3d> force_n;  // on the blade, in W; empty where nothing measures it

  size_t size() const { return time_s.size(); }
};

// A table of it (CSV, one line a period), written whole.
void WriteArmRecord(const ArmRecord& record, const std::filesystem::path& file);

// Index of the planned knot nearest to each measured entry, never going back.
std::vector<size_t> Progress(const ArmRecord& record, const std::vector<JointAngles>& knots);

// Path of the blade in the sand, frame B, while the arm was between the first and the last knot of
// the stroke's path; at most 1 mm and 0.05 rad between poses. `X_BT` gives the blade at joint angles.
ToolPath ExecutedPath(const ArmRecord& record, const StrokeMotion& motion,
                      const std::vector<JointAngles>& knots,
                      const std::function<Eigen::Isometry3d(const JointAngles&)>& X_BT);

}  // namespace sandwright
