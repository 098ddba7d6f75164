#include "robot_model/calibration/joint_list.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <cmath>

#include "data/base/atomic_file.h"
#include "data/base/error.h"

namespace sandwright {

YAML::Node LoadYamlNode(const std::filesystem::path& file) {
  try {
    return YAML::Load(ReadFile(file));
  } catch (const YAML::Exception& e) {
    throw Error(fmt::format("{}: not YAML: {}", file.string(), e.what()));
  }
}

std::vector<double> ReadNumbers(const YAML::Node& node, size_t count, const std::string& where) {
  if (!node || !node.IsSequence() || node.size() != count)
    throw Error(fmt::format("{}: a list of {} numbers is needed", where, count));
  std::vector<double> numbers;
  for (const YAML::Node& entry : node) {
    double number = 0;
    if (!entry.IsScalar() || !YAML::convert<double>::decode(entry, number) ||
        !std::isfinite(number))
      throw Error(fmt::format("{}: '{}' is no number", where,
                              entry.IsScalar() ? entry.Scalar() : "a list"));
    numbers.push_back(number);
  }
  return numbers;
}

std::vector<JointAngles> ReadJointList(const YAML::Node& node, const std::string& where) {
  if (!node || !node.IsSequence())
    throw Error(where + ": a list of joint vectors is needed, six angles each [rad]");
  std::vector<JointAngles> list;
  for (size_t i = 0; i < node.size(); ++i) {
    const std::string entry = fmt::format("{}, entry {}", where, i + 1);
    list.push_back(JointAngles::FromList(ReadNumbers(node[i], 6, entry)));
    const double largest = list.back().rad.cwiseAbs().maxCoeff();
    if (largest > 6.2832)
      throw Error(fmt::format("{}: an angle of {}; allowed: +-6.2832 rad. Degrees?", entry,
                              largest));
  }
  return list;
}

std::vector<JointAngles> ReadJointList(const std::filesystem::path& file) {
  const YAML::Node root = LoadYamlNode(file);
  if (root.IsMap()) return ReadJointList(root["joints_rad"], file.string() + ": joints_rad");
  return ReadJointList(root, file.string());
}

}  // namespace sandwright
