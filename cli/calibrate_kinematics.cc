// sandwright calibrate kinematics: the arm's factory calibration into the workcell file.
#include <spdlog/fmt/fmt.h>

#include "cli/calibrate.h"
#include "cli/command.h"
#include "cli/deploy_run.h"
#include "data/base/error.h"
#include "robot_model/calibration/factory_kinematics.h"
#include "robot_model/controller/arm_identity.h"

namespace sandwright {
namespace {

class CalibrateKinematicsCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    auto* file = app.add_option("--from-file", file_, "the controller's calibration.conf, or YAML");
    app.add_option("--arm", arm_, "or: the controller's address, which is only asked")
        ->excludes(file);
    app.add_flag("--armed", armed_, "allow another address than loopback");
    cell_.Declare(app);
  }
  void Fields(FieldList& f) override { f.Section("controller", ports_); }

  int Run() override {
    if (file_.empty() && arm_.empty())
      throw Error("neither --from-file nor --arm; one of them is needed");
    Workcell cell = cell_.Load();
    const DhParameters old = cell.kinematics;
    const std::string old_hash = CalibrationHash(cell);
    cell.kinematics = arm_.empty() ? ReadFactoryKinematics(file_) : AskController();
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
  DhParameters AskController() const {
    const ArmIdentity identity =
        ReadIdentity({arm_, static_cast<uint16_t>(ports_.dashboard_port),
                      static_cast<uint16_t>(ports_.primary_port),
                      static_cast<uint16_t>(ports_.rtde_port)},
                     armed_);
    fmt::print("{} {}\n", identity.model, identity.serial_number);
    CheckFactoryKinematics(identity.kinematics, arm_);
    return identity.kinematics;
  }

  CalibratedCell cell_;
  ControllerPortSettings ports_;
  std::string file_, arm_;
  bool armed_ = false;
};

}  // namespace

std::unique_ptr<Command> MakeCalibrateKinematicsCommand() {
  return std::make_unique<CalibrateKinematicsCommand>();
}

}  // namespace sandwright
