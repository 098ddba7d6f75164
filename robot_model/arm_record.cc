#include "robot_model/arm_record.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <numbers>

#include "data/base/atomic_file.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr double kPathStep_m = 1e-3, kPathTurn_rad = 0.05;
// Knots ahead among which the nearest is looked for: 2 s of motion at full speed.
constexpr size_t kLookAhead = 250;

}  // namespace

void WriteArmRecord(const ArmRecord& record, const std::filesystem::path& file) {
  std::string text = "time_s";
  for (const char* what : {"commanded", "measured", "speed"})
    for (int joint = 1; joint <= 6; ++joint)
      text += fmt::format(",{}_{}_{}", what, joint, what[0] == 's' ? "radps" : "rad");
  if (!record.force_n.empty()) text += ",force_x_n,force_y_n,force_z_n";
  text += '\n';
  for (size_t i = 0; i < record.size(); ++i) {
    text += fmt::format("{:.3f}", record.time_s[i]);
    for (const Vector6* row :
         {&record.commanded[i].rad, &record.measured[i].rad, &record.speed_radps[i]})
      for (const double value : *row) text += fmt::format(",{:.6f}", value);
    if (!record.force_n.empty())
      for (const double value : record.force_n[i]) text += fmt::format(",{:.2f}", value);
    text += '\n';
  }
  WriteFileAtomically(file, text);
}

std::vector<size_t> Progress(const ArmRecord& record, const std::vector<JointAngles>& knots) {
  SAND_CHECK(!knots.empty());
  std::vector<size_t> progress;
  size_t at = 0;
  for (const JointAngles& q : record.measured) {
    double nearest = (knots[at].rad - q.rad).squaredNorm();
    for (size_t k = at + 1; k < std::min(knots.size(), at + kLookAhead); ++k) {
      const double distance = (knots[k].rad - q.rad).squaredNorm();
      if (distance < nearest) nearest = distance, at = k;
    }
    progress.push_back(at);
  }
  return progress;
}

ToolPath ExecutedPath(const ArmRecord& record, const StrokeMotion& motion,
                      const std::vector<JointAngles>& knots,
                      const std::function<Eigen::Isometry3d(const JointAngles&)>& X_BT) {
  const size_t before = knots.size() - motion.knots.size();
  const std::vector<size_t> progress = Progress(record, knots);
  ToolPath path;
  std::optional<BladePose> last;  // seen, though perhaps too near to be kept
  for (size_t i = 0; i < record.size(); ++i) {
    if (progress[i] < before + motion.path_begin || progress[i] >= before + motion.path_end)
      continue;
    const Eigen::Isometry3d X = X_BT(record.measured[i]);
    const Eigen::Vector3d normal = (motion.flipped ? -1 : 1) * X.linear().col(0);
    BladePose pose{X.translation().x(), X.translation().y(), X.translation().z(),
                   std::atan2(normal.y(), normal.x())};
    if (!path.empty()) {
      const BladePose& back = path.back();
      constexpr double kTurn = 2 * std::numbers::pi;
      pose.yaw_rad -= kTurn * std::round((pose.yaw_rad - back.yaw_rad) / kTurn);
      last = pose;
      if (std::hypot(pose.x_m - back.x_m, pose.y_m - back.y_m, pose.z_m - back.z_m) <=
              kPathStep_m &&
          std::abs(pose.yaw_rad - back.yaw_rad) < kPathTurn_rad)
        continue;
    }
    path.push_back(pose);
    last.reset();
  }
  if (last) path.push_back(*last);
  return path;
}

}  // namespace sandwright
