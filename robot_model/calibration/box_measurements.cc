#include "robot_model/calibration/box_measurements.h"

#include <spdlog/fmt/fmt.h>
#include <yaml-cpp/yaml.h>

#include <opencv2/calib3d.hpp>
#include <regex>

#include "data/base/error.h"
#include "robot_model/calibration/joint_list.h"

namespace sandwright {
namespace {

// The ray through a pixel with the distortion taken out, z = 1.
Eigen::Vector3d RayOf(const Eigen::Vector2d& pixel, const CameraModel& camera) {
  const cv::Matx33d k(camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1);
  const cv::Vec<double, 5> distortion(camera.k1, camera.k2, camera.p1, camera.p2, camera.k3);
  std::vector<cv::Point2d> ray;
  cv::undistortPoints(std::vector<cv::Point2d>{{pixel.x(), pixel.y()}}, ray, k, distortion,
                      cv::noArray(), cv::noArray(),
                      cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 20, 1e-12));
  return {ray[0].x, ray[0].y, 1};
}

}  // namespace

std::vector<RimTouch> ReadRimTouches(const std::filesystem::path& file, const Workcell& cell) {
  static const std::regex form("(x[01])?(y[01])?");
  const YAML::Node root = LoadYamlNode(file);
  if (!root.IsMap() || !root["touches"] || !root["touches"].IsSequence())
    throw Error(file.string() + ": the key `touches` is needed, a list of {at, joints_rad or tcp_m}");
  const Ur10 arm(cell.kinematics);
  std::vector<RimTouch> touches;
  for (const YAML::Node& node : root["touches"]) {
    const std::string where = fmt::format("{}: touch {}", file.string(), touches.size() + 1);
    if (!node.IsMap()) throw Error(where + ": {at, joints_rad or tcp_m} is needed");
    RimTouch touch;
    if (node["at"] && node["at"].IsScalar()) touch.at = node["at"].Scalar();
    if (touch.at.empty() || !std::regex_match(touch.at, form))
      throw Error(fmt::format("{}: at: '{}'; allowed: a wall x0, x1, y0, y1 or a corner such as x0y1",
                              where, touch.at));
    if (static_cast<bool>(node["joints_rad"]) == static_cast<bool>(node["tcp_m"]))
      throw Error(where + ": either joints_rad or tcp_m is needed");
    if (node["joints_rad"]) {
      const auto six = ReadNumbers(node["joints_rad"], 6, where + ": joints_rad");
      touch.p_W = (arm.Forward(JointAngles::FromList(six)) * cell.tool.X_FT.ToIsometry()).translation();
    } else {
      const auto p = ReadNumbers(node["tcp_m"], 3, where + ": tcp_m");
      touch.p_W = {p[0], p[1], p[2]};
      if (touch.p_W.norm() > 2)
        throw Error(fmt::format("{}: tcp_m is {:.3f} m from the base; a UR10 reaches 1.3 m and its "
                                "tool. Millimetres?",
                                where, touch.p_W.norm()));
    }
    touches.push_back(touch);
  }
  return touches;
}

TagLayout ReadTagLayout(const std::filesystem::path& file) {
  const YAML::Node root = LoadYamlNode(file);
  if (!root.IsMap() || !root["tags"] || !root["tags"].IsMap())
    throw Error(file.string() + ": the key `tags` is needed, a map of id: [x, y, z]");
  TagLayout layout;
  if (root["dictionary"]) layout.dictionary = root["dictionary"].as<std::string>();
  for (const auto& entry : root["tags"]) {
    int id = 0;
    const std::string where = fmt::format("{}: tag {}", file.string(), entry.first.Scalar());
    if (!YAML::convert<int>::decode(entry.first, id) || id < 0)
      throw Error(where + ": a whole number is needed");
    const auto p = ReadNumbers(entry.second, 3, where);
    layout.middle_B[id] = {p[0], p[1], p[2]};
  }
  return layout;
}

std::vector<PointSight> SightTags(const std::vector<MarkedFrame>& frames,
                                  const std::vector<JointAngles>& joints, const TagLayout& layout,
                                  const Workcell& cell) {
  if (frames.size() != joints.size())
    throw Error(fmt::format("{} frames and {} joint vectors; one joint vector a frame is needed",
                            frames.size(), joints.size()));
  const Ur10 arm(cell.kinematics);
  std::vector<PointSight> sights;
  for (size_t i = 0; i < frames.size(); ++i)
    for (const MarkedPoint& point : frames[i].points) {
      const auto tag = layout.middle_B.find(point.id);
      if (tag == layout.middle_B.end()) continue;
      sights.push_back({fmt::format("tag {} in {}", point.id, frames[i].name), tag->second,
                        arm.Forward(joints[i]) * cell.tool.X_FC.ToIsometry(),
                        RayOf(point.pixel, cell.camera)});
    }
  return sights;
}

}  // namespace sandwright
