// sandwright check: the safety gate alone, on a plan; --seal writes what the plan was made for.
#include <spdlog/fmt/fmt.h>

#include "cli/command.h"
#include "data/base/error.h"
#include "data/height_map.h"
#include "robot_model/calibration/cell_calibration.h"
#include "robot_model/plan.h"

namespace sandwright {
namespace {

class CheckCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--plan", plan_file_, "plan (YAML)")->required();
    app.add_option("--terrain", terrain_file_, "height map of the box as it is now")->required();
    app.add_option("--workcell", workcell_file_, "workcell (YAML)")->required();
    app.add_flag("--seal", seal_,
                 "seal the plan where it is accepted: hashes of blade, cell, calibration and scan");
    app.add_flag("--real-arm", real_arm_,
                 "reject the plan too where the cell is not calibrated well enough for a real arm");
  }

  int Run() override {
    Plan plan = ReadPlan(plan_file_);
    const HeightMap terrain = ReadHeightMap(terrain_file_);
    const Workcell workcell = LoadWorkcell(workcell_file_);
    PlanVerdict verdict = CheckPlan(SafetyGate(workcell), plan.strokes, terrain);
    if (real_arm_)
      for (const std::string& fault : CalibrationFaults(workcell)) {
        verdict.reasons.push_back("calibration: " + fault);
        verdict.accepted = false;
      }
    for (size_t i = 0; i < verdict.strokes.size(); ++i) {
      const GateVerdict& stroke = verdict.strokes[i];
      fmt::print(
          "stroke {}: {}  {:.1f} s, joints at {:.0f} % of their speed, {:.0f} mm clear, branch "
          "{}\n",
          i, stroke.accepted ? "accepted" : "REJECTED", stroke.duration_s,
          100 * stroke.peak_joint_speed_share, 1e3 * stroke.min_clearance_m, stroke.branch);
    }
    for (const std::string& reason : verdict.reasons) fmt::print("  - {}\n", reason);
    if (verdict.accepted && seal_) {
      plan.seal = MakeSeal(plan.strokes, workcell, terrain);
      WritePlan(plan, plan_file_);
      fmt::print("sealed: {}\n", plan_file_);
    }
    WriteResult(ToJson(verdict, workcell));
    return verdict.accepted ? 0 : 3;
  }

 private:
  std::string plan_file_, terrain_file_, workcell_file_;
  bool seal_ = false, real_arm_ = false;
};

}  // namespace

std::unique_ptr<Command> MakeCheckCommand() { return std::make_unique<CheckCommand>(); }

}  // namespace sandwright
