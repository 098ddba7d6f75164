// Strokes on a rig, one at a time: look, choose, gate, confirm, execute, look again, compare.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "data/base/run_status.h"
#include "env/sand_model.h"
#include "robot_model/rescan_check.h"
#include "robot_model/rig_driver.h"
#include "robot_model/rig_log.h"

namespace sandwright {

struct DeploymentConfig {
  int64_t max_rejected_in_a_row = 3;
  int64_t scan_attempts = 3;
  double dry_run_speed_share = 0.2;
  double dry_run_clearance_m = 0.030;
  double dry_run_deviation_rad = 0.01;
  double plan_tolerance_m = 0.004;
  bool force_baseline = true;
  ScanConfig scan;
  RescanLimits rescan;

  void Fields(FieldList& f) {
    f.Add("max_rejected_in_a_row", max_rejected_in_a_row,
          "an agent's strokes that the gate may refuse one after another", 1, 100);
    f.Add("scan_attempts", scan_attempts, "looks at the bed before a refused scan ends the run", 1, 100);
    f.Add("dry_run_speed_share", dry_run_speed_share, "of all speeds in a dry run", 0.01, 1);
    f.Add("dry_run_clearance_m", dry_run_clearance_m,
          "blade above the highest sand in a lifted pass [m]", 0.005, 0.5);
    f.Add("dry_run_deviation_rad", dry_run_deviation_rad,
          "furthest that a joint may be from the plan for a dry run to pass [rad]", 1e-4, 0.2);
    f.Add("plan_tolerance_m", plan_tolerance_m,
          "root mean square difference between the plan's scan and the first one, where its first "
          "stroke goes [m]", 0.0005, 0.1);
    f.Add("force_baseline", force_baseline,
          "on an arm that measures force: a lifted pass before each stroke, whose forces are what "
          "the guard compares with");
    f.Section("scan", scan);
    f.Section("rescan", rescan);
  }
};

// Where strokes come from. `sensed` is the bed as seen last; none: there is no further one.
using StrokeSource = std::function<std::optional<Stroke>(const HeightMap& sensed, int strokes_used,
                                                         int rejected_in_a_row)>;

enum class DeployMode {
  kDryRun,  // each stroke lifted and slow; the sand stays as it is
  kRun,
};

struct DeploymentJob {
  DeployMode mode = DeployMode::kRun;
  int max_strokes = 20;
  int strokes_used = 0;  // by a run that this one continues
  // A plan's strokes are void when the sand does something else; an agent looks anew.
  bool planned = false;
  std::optional<HeightMap> planned_for = {};  // the scan that a plan was made for
  std::optional<HeightMap> goal = {};
  double success_error_m = 0.002;  // goal error at which it is done
};

// One stroke, refused ones too.
struct DeployedStroke {
  Stroke stroke;
  std::vector<std::string> refused = {};
  std::string end = {};          // of its execution; "" where refused
  double deviation_rad = 0;      // furthest of a measured joint from the plan
  RescanFigures rescan = {};     // kRun
  double goal_error_m = 0;       // after it, with a goal
};

struct Deployment {
  std::string end;     // "done", "goal reached", "budget used", "refused", "rescan", "dry run failed", "not confirmed",
                       // "stopped", or what a motion ended with
  std::string reason;  // for people; empty where nothing went wrong
  bool ok = false;     // ended as it should
  double start_error_m = 0, end_error_m = 0;  // with a goal
  std::vector<DeployedStroke> strokes = {};
  nlohmann::json outcome = {};  // CompareWithVerdict's; null: no verdict, or it did not end as it should

  std::string Outcome() const { return reason.empty() ? end : end + ": " + reason; }
};

// `confirm` is asked before each stroke (none: no question) with a line about it; false ends the run. Every
// motion goes through `log` and the gate. Stops at the first motion that does not finish, at a rescan that is not to be believed and
// after Ctrl-C, and never goes on by itself. `status` (none: nobody watches) is shown each bed. Error where
// the log cannot be written.
Deployment Deploy(Rig& rig, const SafetyGate& gate, const SandModel& model,
                  const StrokeSource& source, const DeploymentJob& job,
                  const DeploymentConfig& config,
                  const std::function<bool(const std::string&)>& confirm, RigLog& log,
                  RunStatus* status = nullptr);

}  // namespace sandwright
