// Joint vectors that were noted down at the pendant.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "robot_model/ur10.h"

namespace YAML {
class Node;
}

namespace sandwright {

// A YAML (or JSON) file as a node. Throws Error naming the file where it is missing or not YAML.
YAML::Node LoadYamlNode(const std::filesystem::path& file);

// `count` finite numbers out of a node; `where` (file and key) is for the Error.
std::vector<double> ReadNumbers(const YAML::Node& node, size_t count, const std::string& where);

// A list of joint vectors, six angles each [rad, within +-2 pi]. Throws Error naming the entry.
std::vector<JointAngles> ReadJointList(const YAML::Node& node, const std::string& where);

// The same out of a file: a list, or a list under the key `joints_rad`.
std::vector<JointAngles> ReadJointList(const std::filesystem::path& file);

}  // namespace sandwright
