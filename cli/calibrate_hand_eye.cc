// sandwright calibrate hand-eye: where the camera is on the flange, from pictures of a board.
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <numbers>

#include "cli/calibrate.h"
#include "cli/command.h"
#include "robot_model/calibration/hand_eye.h"
#include "robot_model/calibration/joint_list.h"

namespace sandwright {
namespace {

class CalibrateHandEyeCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--frames", frames_,
                   "grey or infrared pictures of the board, their folder, or one YAML or JSON file "
                   "of corners found by another program")
        ->required();
    app.add_option("--joints", joints_, "one joint vector a frame, in their order (YAML) [rad]")
        ->required();
    app.add_option("--board", board_,
                   "ChArUco: COLUMNSxROWS,SQUARE_M,MARKER_M[,DICTIONARY], for example "
                   "7x5,0.040,0.030,4X4_50")
        ->required();
    cell_.Declare(app);
  }

  int Run() override {
    const CharucoBoard board = ParseBoard(board_);
    Workcell cell = cell_.Load();
    const auto frames = ReadFrames(
        frames_, [&](const cv::Mat& grey) { return DetectBoard(grey, board); });
    const HandEyeCalibration found = CalibrateHandEye(frames, ReadJointList(joints_), board, cell);
    for (const std::string& reason : found.refused) spdlog::warn("left out: {}", reason);
    nlohmann::json solvers;
    for (const HandEyeSolver& solver : found.solvers) {
      const double held_out_deg = solver.held_out_rad * 180 / std::numbers::pi;
      fmt::print("{:<13} held out {:8.3f} mm {:7.3f} degrees{}\n", solver.name,
                 1e3 * solver.held_out_m, held_out_deg,
                 solver.name == found.solver ? "  <- taken" : "");
      solvers.push_back({{"name", solver.name},
                         {"held_out_m", solver.held_out_m},
                         {"held_out_rad", solver.held_out_rad}});
    }
    cell.tool.X_FC = PoseSetting::FromIsometry(found.X_FC);
    std::vector<std::string> values = CameraKeys();
    values.insert(values.begin(), "tool.X_FC");
    CalibrationRecord& record = cell.calibration.hand_eye;
    record = MakeRecord(cell, found.error, values);
    nlohmann::json result = cell_.Save(cell, record);
    result["X_FC"] = PoseJson(cell.tool.X_FC);
    result["solver"] = found.solver;
    result["solvers"] = solvers;
    result["rotation_spread_rad"] = found.rotation_spread_rad;
    result["refused_frames"] = found.refused;
    WriteResult(result);
    return 0;
  }

 private:
  CalibratedCell cell_;
  std::vector<std::string> frames_;
  std::string joints_, board_;
};

}  // namespace

std::unique_ptr<Command> MakeCalibrateHandEyeCommand() {
  return std::make_unique<CalibrateHandEyeCommand>();
}

}  // namespace sandwright
