// sandwright calibrate kinematics: the arm's factory calibration into the workcell file.
#include <spdlog/fmt/fmt.h>

#include "cli/calibrate.h"
#include "cli/command.h"
#include "data/base/error.h"
#include "robot_model/calibration/factory_kinematics.h"

namespace sandwright {
namespace {

class CalibrateKinematicsCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--from-file", file_, "the controller's calibration.conf, or YAML")->required();
    cell_.Declare(app);
  }

  int Run() override {
    Workcell cell = cell_.Load();
    const DhParameters old = cell.kinematics;
    const std::string old_hash = CalibrationHash(cell);
    cell.kinematics = ReadFactoryKinematics(file_);
    const FlangeShift shift = MeasureFlangeShift(old, cell.kinematics);
    fmt::print("kinematics {:.12}... -> {:.12}...\n", old_hash, CalibrationHash(cell));
    fmt::print("the flange moves by p50 {:.2f}, p95 {:.2f}, at most {:.2f} mm over 1000 poses\n",
               1e3 * shift.p50_m, 1e3 * shift.p95_m, 1e3 * shift.max_m);
    CalibrationRecord& record = cell.calibration.kinematics;
    record = MakeRecord(cell, {}, {"kinematics"});
    nlohmann::json result = cell_.Save(cell, record);
    result["old_kinematics_hash"] = old_hash;
    result["flange_shift_p50_m"] = shift.p50_m;
    result["flange_shift_p95_m"] = shift.p95_m;
    result["flange_shift_max_m"] = shift.max_m;
    WriteResult(result);
    return 0;
  }

 private:
  CalibratedCell cell_;
  std::string file_;
};

}  // namespace

std::unique_ptr<Command> MakeCalibrateKinematicsCommand() {
  return std::make_unique<CalibrateKinematicsCommand>();
}

}  // namespace sandwright
