#include "agents/deployment.h"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "data/base/error.h"
#include "data/base/stop.h"
#include "data/bed_pictures.h"
#include "data/task.h"

namespace sandwright {
namespace {

// Root mean square difference of two scans where the stroke goes.
double SwathDifference_m(const HeightMap& a, const HeightMap& b, const Stroke& stroke,
                         const RescanLimits& limits) {
  ScanResult seen;
  seen.accepted = true;
  seen.map = b;
  return CheckRescan(a, a, seen, SamplePath(stroke, a.cell_size_m), limits).change_rms_m;
}

class Run {
 public:
  Run(Rig& rig, const SafetyGate& gate, const SandModel& model, const StrokeSource& source,
      const DeploymentJob& job, const DeploymentConfig& config,
      const std::function<bool(const std::string&)>& confirm, RigLog& log, RunStatus* status)
      : rig_(rig, log),
        driver_(rig_, gate, config.scan),
        gate_(gate),
        model_(model),
        source_(source),
        job_(job),
        config_(config),
        confirm_(confirm),
        log_(log),
        status_(status),
        head_{rig.name() == "simulated" ? "simulated" : "rig",
              std::filesystem::absolute(log.folder()).filename().string(), 0,
              nlohmann::json({{"rig", rig.name()}}).dump(), {}, WorkcellHash(gate.workcell())} {}

  Deployment Go() {
    if (Look()) {
      if (job_.goal) result_.start_error_m = result_.end_error_m = GoalError(sensed_, *job_.goal);
      do Tell();
      while (Next());
    }
    log_.Add("end", {{"end", result_.end}, {"reason", result_.reason}});
    return std::move(result_);
  }

 private:
  bool End(std::string end, std::string reason, bool ok = false) {
    result_.end = std::move(end);
    result_.reason = std::move(reason);
    result_.ok = ok;
    return false;
  }

  // For whoever watches: the bed and what is known of it.
  void Tell() {
    if (!status_) return;
    nlohmann::json figures = {{"strokes_refused_in_a_row", rejected_in_a_row_}};
    if (job_.goal) {
      figures["in_goal_mean_diff_start_mm"] = 1e3 * result_.start_error_m;
      figures["in_goal_mean_diff_mm"] = 1e3 * result_.end_error_m;
    }
    if (!result_.strokes.empty()) {
      const RescanFigures& rescan = result_.strokes.back().rescan;
      figures["prediction_rmse_mm"] = 1e3 * rescan.prediction_rmse_m;
      figures["change_rms_mm"] = 1e3 * rescan.change_rms_m;
    }
    status_->Figures(figures);
    status_->Show(BedPictures(sensed_, job_.goal));
    status_->Advance(used_, job_.max_strokes, "strokes");
  }

  // A drive that did not finish ends the run.
  bool Finished(const Drive& drive) {
    if (drive.finished()) return true;
    return End(drive.refused.empty() ? drive.execution->end : "refused", drive.why());
  }

  // To the camera; the accepted map is what is sensed. Ends the run where that fails.
  bool Look() {
    for (int64_t attempt = 0; attempt < config_.scan_attempts; ++attempt) {
      RigDriver::Seen seen = driver_.Look();
      if (!Finished(seen.drive)) return false;
      scan_ = std::move(seen.scan);
      log_.AddScan(scan_);
      if (scan_.accepted) break;
    }
    if (scan_.accepted) sensed_ = scan_.map;
    return scan_.accepted || End("rescan", fmt::format("{}", fmt::join(scan_.reasons, "; ")));
  }

  bool Next() {
    if (StopRequested()) return End("stopped", "stopped by the operator");
    if (job_.goal && result_.end_error_m <= job_.success_error_m)
      return End("goal reached", "", true);
    if (used_ >= job_.max_strokes) return End("budget used", "", true);
    const auto stroke = source_(sensed_, used_, rejected_in_a_row_);
    if (!stroke) return End("done", "", true);
    if (job_.planned_for && used_ == 0) {
      const double off = SwathDifference_m(*job_.planned_for, sensed_, *stroke, config_.rescan);
      if (off > config_.plan_tolerance_m)
        return End("rescan", fmt::format("the sand is not what the plan was made for: {:.1f} mm rms "
                                         "where the first stroke goes; limit {:.1f} mm",
                                         1e3 * off, 1e3 * config_.plan_tolerance_m));
    }
    result_.strokes.push_back({.stroke = *stroke});
    ++used_;
    return Perform(*stroke, result_.strokes.back());
  }

  bool Perform(const Stroke& stroke, DeployedStroke& done) {
    done.goal_error_m = result_.end_error_m;
    const GateVerdict verdict = gate_.Check(stroke, *driver_.latest(), GateSampling::kFine, {});
    log_.Add("choice", {{"stroke", used_ - 1}, {"accepted", verdict.accepted}, {"reasons", verdict.reasons}});
    if (!verdict.accepted) return Refused(done, verdict.reasons);
    if (confirm_ && !confirm_(fmt::format("stroke {}: {:.1f} s, {:.0f} mm clear", used_ - 1,
                                          verdict.duration_s, 1e3 * verdict.min_clearance_m)))
      return End("not confirmed", "the operator said no");
    return job_.mode == DeployMode::kDryRun ? DryRun(stroke, done) : Execute(stroke, done);
  }

  bool Refused(DeployedStroke& done, const std::vector<std::string>& reasons) {
    done.refused = reasons;
    const std::string why = fmt::format("{}", fmt::join(reasons, "; "));
    spdlog::warn("stroke {} refused: {}", used_ - 1, why);
    if (job_.planned) return End("refused", why);
    if (++rejected_in_a_row_ < config_.max_rejected_in_a_row) return true;
    return End("refused", fmt::format("{} strokes in a row; the last: {}", rejected_in_a_row_, why));
  }

  bool DryRun(const Stroke& stroke, DeployedStroke& done) {
    const Drive drive = driver_.RunLifted(stroke, config_.dry_run_clearance_m,
                                          {.speed_share = config_.dry_run_speed_share});
    if (!drive.refused.empty()) return Refused(done, drive.refused);
    done.end = drive.execution->end;
    if (!Finished(drive)) return false;
    rejected_in_a_row_ = 0;
    done.deviation_rad = drive.deviation_rad;
    if (done.deviation_rad > config_.dry_run_deviation_rad)
      return End("dry run failed", fmt::format("a joint was {:.4f} rad from the plan; limit {:.4f} rad",
                                               done.deviation_rad, config_.dry_run_deviation_rad));
    sensed_ = Predict(SamplePath(stroke, sensed_.cell_size_m / 2));
    return Finished(driver_.ToCamera());
  }

  bool Execute(const Stroke& stroke, DeployedStroke& done) {
    std::vector<Eigen::Vector3d> in_air_n;
    if (config_.force_baseline && rig_.measures_force()) {
      const Drive in_air = driver_.RunLifted(stroke, config_.dry_run_clearance_m);
      if (!in_air.refused.empty()) return Refused(done, in_air.refused);
      if (!Finished(in_air)) return false;
      in_air_n = in_air.execution->path_force_n;
    }
    const Drive drive = driver_.Run(stroke, {.in_air_n = std::move(in_air_n)});
    if (!drive.refused.empty()) return Refused(done, drive.refused);
    done.end = drive.execution->end;
    done.deviation_rad = drive.deviation_rad;
    if (!Finished(drive)) return false;
    rejected_in_a_row_ = 0;
    const HeightMap before = sensed_, predicted = Predict(drive.path);
    if (!Look()) return false;
    return Compare(stroke, drive.path, before, predicted, done);
  }

  // What the new scan says to the stroke.
  bool Compare(const Stroke& stroke, const ToolPath& path, const HeightMap& before,
               const HeightMap& predicted, DeployedStroke& done) {
    done.rescan = CheckRescan(before, predicted, scan_, path, config_.rescan);
    if (job_.goal) done.goal_error_m = result_.end_error_m = GoalError(sensed_, *job_.goal);
    nlohmann::json event = ToJson(done.rescan);
    event["stroke"] = used_ - 1;
    if (job_.goal) event["in_goal_mean_diff_mm"] = 1e3 * result_.end_error_m;
    log_.Add("verdict", event);
    if (done.rescan.verdict != RescanVerdict::kStop)
      Keep(stroke, path, before);
    spdlog::info("stroke {}: {}; predicted {:.2f} of {:.2f} mm rms off", used_ - 1,
                 NameOf(done.rescan.verdict), 1e3 * done.rescan.prediction_rmse_m,
                 1e3 * done.rescan.change_rms_m);
    const bool wrong = done.rescan.verdict == RescanVerdict::kStop ||
                       (job_.planned && done.rescan.verdict == RescanVerdict::kReplan);
    return !wrong || End("rescan", fmt::format("{}", fmt::join(done.rescan.reasons, "; ")));
  }

  // Data for `fit`.
  void Keep(const Stroke& stroke, const ToolPath& path, const HeightMap& before) {
    StrokeRecord record;
    record.before = before;
    record.after = sensed_;
    record.stroke = stroke;
    record.path = path;
    record.blade = gate_.workcell().tool.blade;
    log_.AddStroke(head_, std::move(record));
  }

  HeightMap Predict(const ToolPath& path) const {
    SandState state = model_.Start(sensed_, 0);
    model_.Apply({&state, 1}, {&path, 1});
    return state.map();
  }

  LoggedRig rig_;
  RigDriver driver_;
  const SafetyGate& gate_;
  const SandModel& model_;
  const StrokeSource& source_;
  const DeploymentJob& job_;
  const DeploymentConfig& config_;
  const std::function<bool(const std::string&)>& confirm_;
  RigLog& log_;
  RunStatus* status_;
  StrokeFile head_;
  ScanResult scan_;
  HeightMap sensed_;
  int used_ = job_.strokes_used, rejected_in_a_row_ = 0;
  Deployment result_;
};

}  // namespace

Deployment Deploy(Rig& rig, const SafetyGate& gate, const SandModel& model,
                  const StrokeSource& source, const DeploymentJob& job,
                  const DeploymentConfig& config,
                  const std::function<bool(const std::string&)>& confirm, RigLog& log,
                  RunStatus* status) {
  return Run(rig, gate, model, source, job, config, confirm, log, status).Go();
}

}  // namespace sandwright
