// Measurements of the box out of files: touches noted at the pendant, tags in pictures.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "robot_model/calibration/box_pose.h"
#include "robot_model/calibration/marked_frames.h"

namespace sandwright {

// YAML: `touches: [{at: x0, joints_rad: [six angles]}, {at: x0y1, tcp_m: [x, y, z]}, ...]`: joints,
// or the TCP as the pendant shows it, whose TCP must then be the cell's. Throws Error naming the
// touch, its key and what is allowed.
std::vector<RimTouch> ReadRimTouches(const std::filesystem::path& file, const Workcell& workcell);

// Where the middles of the corner tags are in B.
struct TagLayout {
  std::string dictionary = "4X4_50";
  std::map<int, Eigen::Vector3d> middle_B;
};

// YAML: `dictionary: 4X4_50`, `tags: {13: [x, y, z], ...}` [m].
TagLayout ReadTagLayout(const std::filesystem::path& file);

// The tags of the layout in frames taken at those joints, one joint vector a frame; others are passed
// over. Throws Error where the lists differ in length.
std::vector<PointSight> SightTags(const std::vector<MarkedFrame>& frames,
                                  const std::vector<JointAngles>& joints, const TagLayout& layout,
                                  const Workcell& workcell);

}  // namespace sandwright
