// sandwright calibrate box: where the box stands, by touches of its rim, its corner tags or both.
#include <spdlog/fmt/fmt.h>

#include "cli/calibrate.h"
#include "cli/command.h"
#include "data/base/error.h"
#include "data/base/json_number.h"
#include "robot_model/calibration/box_measurements.h"
#include "robot_model/calibration/joint_list.h"

namespace sandwright {
namespace {

class CalibrateBoxCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--touches", touches_,
                   "YAML: `touches` of the rim's inner edge, each {at: x0 | x1 | y0 | y1 | a corner "
                   "such as x0y1, joints_rad or tcp_m}");
    auto* tags = app.add_option(
        "--tags", tags_, "YAML: `tags`, {id: [x, y, z]}, their middles in the box [m]");
    auto* frames =
        app.add_option("--frames", frames_,
                       "pictures that show the tags, their folder, or one file of their middles");
    auto* joints = app.add_option("--joints", joints_, "one joint vector a frame (YAML) [rad]");
    tags->needs(frames)->needs(joints);
    frames->needs(tags);
    joints->needs(tags);
    cell_.Declare(app);
  }

  int Run() override {
    if (touches_.empty() && tags_.empty())
      throw Error("neither --touches nor --tags; at least one is needed");
    Workcell cell = cell_.Load();
    BoxMeasurements measurements;
    std::vector<std::string> values = {"X_WB", "box.width_m", "box.depth_m", "box.wall_height_m"};
    if (!touches_.empty()) {
      measurements.touches = ReadRimTouches(touches_, cell);
      values.push_back("tool.X_FT");
    }
    if (!tags_.empty()) {
      const TagLayout layout = ReadTagLayout(tags_);
      const auto frames = ReadFrames(
          frames_, [&](const cv::Mat& grey) { return DetectTags(grey, layout.dictionary); });
      measurements.sights = SightTags(frames, ReadJointList(joints_), layout, cell);
      values.push_back("tool.X_FC");
      for (const std::string& key : CameraKeys()) values.push_back(key);
    }
    const BoxCalibration found = CalibrateBox(measurements, cell);
    cell.X_WB = PoseSetting::FromIsometry(found.X_WB);
    fmt::print("{} touches, {} sights of tags; worst corner error {:.1f} times one measurement's\n",
               measurements.touches.size(), measurements.sights.size(), found.dilution);
    if (found.disagreement_m)
      fmt::print("touches and tags agree within {:.2f} mm\n", 1e3 * *found.disagreement_m);
    CalibrationRecord& record = cell.calibration.box;
    record = MakeRecord(cell, found.error, values);
    nlohmann::json result = cell_.Save(cell, record);
    result["X_WB"] = PoseJson(cell.X_WB);
    result["dilution"] = found.dilution;
    result["disagreement_m"] = JsonNumber(found.disagreement_m);
    result["width_m"] = JsonNumber(found.width_m);
    result["depth_m"] = JsonNumber(found.depth_m);
    WriteResult(result);
    return 0;
  }

 private:
  CalibratedCell cell_;
  std::string touches_, tags_, joints_;
  std::vector<std::string> frames_;
};

}  // namespace

std::unique_ptr<Command> MakeCalibrateBoxCommand() {
  return std::make_unique<CalibrateBoxCommand>();
}

}  // namespace sandwright
