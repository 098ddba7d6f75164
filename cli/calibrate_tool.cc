// sandwright calibrate tool: where the blade is on the flange, and what the flange carries.
#include <spdlog/fmt/fmt.h>

#include "cli/calibrate.h"
#include "cli/command.h"
#include "robot_model/calibration/tool_tip.h"

namespace sandwright {
namespace {

class CalibrateToolCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--touches", touches_,
                   "YAML: `tip`, four or more joint vectors with the blade's middle on one point; "
                   "`edge`, optional, two with its ends on it")
        ->required();
    app.add_option("--mass-kg", mass_kg_, "all that the flange carries, as on the pendant")
        ->check(CLI::Range(0.0, 10.0));
    app.add_option("--centre-of-mass-m", centre_of_mass_m_, "of it in F, as on the pendant: x y z")
        ->expected(3)
        ->check(CLI::Range(-1.0, 1.0));
    cell_.Declare(app);
  }

  int Run() override {
    Workcell cell = cell_.Load();
    const ToolTouches touches = ReadToolTouches(touches_);
    const ToolCalibration found = CalibrateTool(touches, cell);
    cell.tool.X_FT = PoseSetting::FromIsometry(found.X_FT);
    if (mass_kg_) cell.tool.mass_kg = *mass_kg_;
    if (!centre_of_mass_m_.empty()) cell.tool.centre_of_mass_m = centre_of_mass_m_;
    const std::vector<double>& p = cell.tool.X_FT.translation_m;
    fmt::print("X_FT {:.2f} {:.2f} {:.2f} mm, the orientation {}; worst tip error {:.1f} times a "
               "touch's\n",
               1e3 * p[0], 1e3 * p[1], 1e3 * p[2],
               touches.edge ? "from the edge's ends" : "as it was", found.dilution);
    CalibrationRecord& record = cell.calibration.tool;
    record = MakeRecord(cell, found.error,
                        {"tool.X_FT", "tool.mass_kg", "tool.centre_of_mass_m"});
    nlohmann::json result = cell_.Save(cell, record);
    result["X_FT"] = PoseJson(cell.tool.X_FT);
    result["dilution"] = found.dilution;
    if (touches.edge) result["edge_length_m"] = found.edge_length_m;
    WriteResult(result);
    return 0;
  }

 private:
  CalibratedCell cell_;
  std::string touches_;
  std::optional<double> mass_kg_;
  std::vector<double> centre_of_mass_m_;
};

}  // namespace

std::unique_ptr<Command> MakeCalibrateToolCommand() {
  return std::make_unique<CalibrateToolCommand>();
}

}  // namespace sandwright
