// sandwright workcell: a cell in figures, and as a picture from above.
#include <spdlog/fmt/fmt.h>

#include "cli/calibrate.h"
#include "cli/command.h"
#include "data/picture.h"
#include "robot_model/workcell_picture.h"

namespace sandwright {
namespace {

class WorkcellCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--workcell", workcell_file_, "workcell (YAML)")->required();
    app.add_option("--picture", picture_file_, "draw it from above (PNG)");
  }

  int Run() override {
    const Workcell cell = LoadWorkcell(workcell_file_);
    const double coverage = CameraCoverage(cell);
    const std::vector<std::string> faults = CalibrationFaults(cell);
    if (!picture_file_.empty()) WritePicture(DrawWorkcell(SafetyGate(cell)), picture_file_);
    fmt::print("{}: the camera sees {:.1f} % of the box floor\n", cell.name, 100 * coverage);
    for (const std::string& fault : faults) fmt::print("  not ready for an arm: {}\n", fault);
    WriteResult({{"name", cell.name},
                 {"camera_coverage_share", coverage},
                 {"workcell_hash", WorkcellHash(cell)},
                 {"kinematics_hash", CalibrationHash(cell)},
                 {"X_WB", PoseJson(cell.X_WB)},
                 {"X_FT", PoseJson(cell.tool.X_FT)},
                 {"X_FC", PoseJson(cell.tool.X_FC)},
                 {"calibration_faults", faults}});
    return 0;
  }

 private:
  std::string workcell_file_, picture_file_;
};

}  // namespace

std::unique_ptr<Command> MakeWorkcellCommand() { return std::make_unique<WorkcellCommand>(); }

}  // namespace sandwright
