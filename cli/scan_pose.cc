#include "cli/scan_pose.h"

#include <spdlog/fmt/fmt.h>

#include <regex>

#include "robot_model/camera_pose.h"

namespace sandwright {
namespace {

struct JointsFile {
  std::vector<double> joints_rad;

  void Fields(FieldList& f) { f.Add("joints_rad", joints_rad, "base to wrist 3 [rad]", -6.3, 6.3); }
};

std::optional<Eigen::Vector2d> ParseBoxSize(const std::string& text) {
  if (text.empty()) return std::nullopt;
  static const std::regex form(R"((\d*\.?\d+)x(\d*\.?\d+))");
  std::smatch match;
  if (!std::regex_match(text, match, form))
    throw Error("--box " + text + " is not a size; expected WxH in m, for example 1.2x0.8");
  return Eigen::Vector2d(std::stod(match[1]), std::stod(match[2]));
}

}  // namespace

ScanPlace PlaceOfScan(const std::string& box, const std::string& workcell,
                      const std::string& joints, const std::optional<double>& sand_depth_m) {
  ScanPlace place{ParseBoxSize(box), std::nullopt, sand_depth_m};
  if (workcell.empty() != joints.empty())
    throw Error(
        "--workcell and --joints belong together: the cell places the camera on the arm, the "
        "joints the arm");
  if (workcell.empty()) return place;
  const Workcell cell = LoadWorkcell(workcell);
  JointsFile angles;
  LoadYaml(FieldsOf(angles), joints);
  if (angles.joints_rad.size() != 6)
    throw Error(fmt::format("{}: joints_rad has {} angles; 6 are needed", joints,
                            angles.joints_rad.size()));
  const Eigen::Vector2d size_m(cell.box.width_m, cell.box.depth_m);
  if (place.box_size_m && (*place.box_size_m - size_m).norm() > 1e-6)
    throw Error(
        fmt::format("--box {} contradicts {}: {} x {} m", box, workcell, size_m.x(), size_m.y()));
  place.box_size_m = size_m;
  place.X_BC = CameraInBox(cell, JointAngles::FromList(angles.joints_rad));
  return place;
}

}  // namespace sandwright
