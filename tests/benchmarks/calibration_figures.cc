// How well a cell is known after its calibrations, over simulated ones at several levels of noise.
// Prints JSON: calibration_figures > docs/results/calibration.json
#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>

#include "data/base/error.h"
#include "data/base/machine.h"
#include "tests/support/simulated_calibration.h"

namespace sandwright {
namespace {

constexpr int kCalibrations = 100;
constexpr size_t kFrames = 20, kTipTouches = 8;

// What came out of a hundred calibrations of one kind.
struct Tally {
  std::vector<double> error, turn, held_out;
  int refused = 0;

  static double Quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0;
    std::ranges::sort(values);
    return values[static_cast<size_t>(share * static_cast<double>(values.size() - 1))];
  }
  nlohmann::json ToJson() const {
    nlohmann::json row = {{"error_p50_mm", 1e3 * Quantile(error, 0.5)},
                          {"error_p95_mm", 1e3 * Quantile(error, 0.95)},
                          {"held_out_p50_mm", 1e3 * Quantile(held_out, 0.5)},
                          {"held_out_p95_mm", 1e3 * Quantile(held_out, 0.95)},
                          {"refused", refused}};
    if (!turn.empty()) {
      row["turn_p50_deg"] = Quantile(turn, 0.5) * 180 / std::numbers::pi;
      row["turn_p95_deg"] = Quantile(turn, 0.95) * 180 / std::numbers::pi;
    }
    return row;
  }
};

// One calibration; a set that is refused is counted, not an error.
template <class Calibrate>
void Add(Tally& tally, const Calibrate& calibrate) {
  try {
    calibrate();
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kRefused) throw;
    ++tally.refused;
  }
}

double Turn_rad(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle();
}

double WorstCorner_m(const Workcell& truth, const Eigen::Isometry3d& X_WB) {
  double worst = 0;
  for (const double x : {0.0, truth.box.width_m})
    for (const double y : {0.0, truth.box.depth_m}) {
      const Eigen::Vector3d p(x, y, truth.box.wall_height_m);
      worst = std::max(worst, (X_WB * p - truth.X_WB.ToIsometry() * p).norm());
    }
  return worst;
}

nlohmann::json Level(double pixel, double touch_m) {
  const MeasurementNoise noise{pixel, touch_m, MeasurementNoise{}.joint_rad};
  Tally hand_eye, tool, touched, tagged;
  std::map<std::string, int> taken;
  for (int i = 0; i < kCalibrations; ++i) {
    RandomStream stream(1, StreamId("calibration figures"), static_cast<uint64_t>(i));
    const Workcell truth = TrueCell(stream);
    Workcell cell = NominalCell(truth);
    const CharucoBoard board;
    Add(hand_eye, [&] {
      const auto measured = MeasureHandEye(truth, board, kFrames, noise, stream);
      const auto found = CalibrateHandEye(measured.frames, measured.joints, board, cell);
      const Eigen::Isometry3d X_FC = truth.tool.X_FC.ToIsometry();
      hand_eye.error.push_back((found.X_FC.translation() - X_FC.translation()).norm());
      hand_eye.turn.push_back(Turn_rad(found.X_FC, X_FC));
      hand_eye.held_out.push_back(found.error.held_out_m);
      ++taken[found.solver];
      cell.tool.X_FC = PoseSetting::FromIsometry(found.X_FC);
    });
    Add(tool, [&] {
      const auto found = CalibrateTool(MeasureTool(truth, kTipTouches, noise, stream), cell);
      tool.error.push_back(
          (found.X_FT.translation() - truth.tool.X_FT.ToIsometry().translation()).norm());
      tool.turn.push_back(Turn_rad(found.X_FT, truth.tool.X_FT.ToIsometry()));
      tool.held_out.push_back(found.error.held_out_m);
      cell.tool.X_FT = PoseSetting::FromIsometry(found.X_FT);
    });
    // With the tool and the camera as they were calibrated just now, errors and all.
    Add(touched, [&] {
      auto rim = MeasureRim(truth, noise, stream);
      const Eigen::Vector3d tip_error_F =
          cell.tool.X_FT.ToIsometry().translation() - truth.tool.X_FT.ToIsometry().translation();
      // The flange hangs upside down over the box.
      for (RimTouch& touch : rim)
        touch.p_W += Eigen::Vector3d(tip_error_F.x(), -tip_error_F.y(), -tip_error_F.z());
      const auto found = CalibrateBox({rim, {}}, cell);
      touched.error.push_back(WorstCorner_m(truth, found.X_WB));
      touched.held_out.push_back(found.error.held_out_m);
    });
    Add(tagged, [&] {
      auto tags = MeasureTags(truth, noise, stream);
      const Eigen::Isometry3d X_CtrueC =
          truth.tool.X_FC.ToIsometry().inverse() * cell.tool.X_FC.ToIsometry();
      for (PointSight& sight : tags) sight.X_WC = sight.X_WC * X_CtrueC;
      const auto found = CalibrateBox({{}, tags}, cell);
      tagged.error.push_back(WorstCorner_m(truth, found.X_WB));
      tagged.held_out.push_back(found.error.held_out_m);
    });
  }
  nlohmann::json row = {{"corner_noise_px", pixel},
                        {"touch_noise_mm", 1e3 * touch_m},
                        {"hand_eye", hand_eye.ToJson()},
                        {"tool", tool.ToJson()},
                        {"box_by_touches", touched.ToJson()},
                        {"box_by_tags", tagged.ToJson()}};
  row["hand_eye"]["solver_taken"] = taken;
  return row;
}

int Main() {
  nlohmann::json levels;
  for (const auto& [pixel, touch_m] :
       {std::pair{0.05, 0.0002}, std::pair{0.15, 0.0004}, std::pair{0.4, 0.001}})
    levels.push_back(Level(pixel, touch_m));
  std::cout << nlohmann::json{{"command", "build/tests/calibration_figures"},
                              {"calibrations", kCalibrations},
                              {"frames", kFrames},
                              {"tip_touches", kTipTouches},
                              {"rim_touches", 8},
                              {"tag_sights", 16},
                              {"joint_noise_rad", MeasurementNoise{}.joint_rad},
                              {"levels", levels},
                              {"version", BuildVersion()},
                              {"commit", BuildCommit()},
                              {"machine", MachineDescription()}}
                   .dump(2)
            << "\n";
  return 0;
}

}  // namespace
}  // namespace sandwright

int main() { return sandwright::Main(); }
