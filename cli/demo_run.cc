#include "cli/demo_run.h"

#include <spdlog/fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "agents/load_agent.h"
#include "cli/verdict_files.h"
#include "data/shipped.h"
#include "data/task.h"
#include "env/arm_picture.h"
#include "env/goals.h"
#include "env/load_sand_model.h"
#include "robot_model/plan.h"
#include "robot_model/rig_driver.h"
#include "robot_model/urscript.h"

namespace sandwright {
namespace {

// Seconds of each named part, in order.
class Timings {
 public:
  void Mark(const std::string& part) {
    const auto now = std::chrono::steady_clock::now();
    parts_.emplace_back(part, std::chrono::duration<double>(now - last_).count());
    spdlog::info("{}: {:.1f} s", part, parts_.back().second);
    last_ = now;
  }
  const std::vector<std::pair<std::string, double>>& parts() const { return parts_; }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::vector<std::pair<std::string, double>> parts_;
};

// Grey picture: near is bright, no reading is black; the range of the middle 96 % of the readings.
cv::Mat DrawFrame(const DepthFrame& frame) {
  std::vector<float> readings;
  std::ranges::copy_if(frame.depth_m, std::back_inserter(readings), [](float z) { return z > 0; });
  std::ranges::sort(readings);
  const float near = readings[readings.size() / 50],
              far = readings[readings.size() - 1 - readings.size() / 50];
  cv::Mat image(frame.height, frame.width, CV_8UC3);
  for (int v = 0; v < frame.height; ++v) {
    for (int u = 0; u < frame.width; ++u) {
      const float z = frame.At(u, v);
      const auto grey =
          z > 0 ? cv::saturate_cast<uchar>(40 + 215 * (far - z) / std::max(far - near, 1e-3f))
                : uchar{0};
      image.at<cv::Vec3b>(v, u) = {grey, grey, grey};
    }
  }
  return image;
}

// The shipped cell with the camera of the frame and a box of the scanned size in front of the arm.
Workcell CellFor(const HeightMap& terrain, const CameraModel& camera) {
  Workcell cell = LoadWorkcell(ShippedConfig("workcell.yaml"));
  static_cast<CameraModel&>(cell.camera) = camera;
  cell.box.width_m = terrain.width_m();
  cell.box.depth_m = terrain.depth_m();
  cell.X_WB.translation_m[0] = -terrain.width_m() / 2;
  return cell;
}

GoalShape ShapeFor(const DemoConfig& config, const Region& region) {
  return {.kind = ParseGoalKind(config.goal),
          .x_m = region.x_m + region.width_m / 2,
          .y_m = region.y_m + region.depth_m / 2,
          .heading_rad = 0.5,
          .half_length_m = 0.05,
          .half_width_m = 0.03,
          .rise_m = 0.02};
}

struct ExecutedStroke {
  ToolPath path;  // of the blade in the sand
  ArmRecord record;
};

// To the camera and a look at the bed. Error where the gate or the scan refuses.
HeightMap LookAt(RigDriver& driver) {
  const RigDriver::Seen seen = driver.Look();
  if (!seen.drive.finished()) throw Error("no rescan: " + seen.drive.why());
  if (!seen.scan.accepted) throw Error("the rescan was refused", seen.scan.reasons);
  return seen.scan.map;
}

// One agent on its own copy of the bed; the same seed for each, so that luck is shared.
DemoRun RunAgent(Agent& agent, const SandModel& model, const SafetyGate& gate,
                 const ShapingJob& job, const SandModel& world, const DemoConfig& config,
                 uint64_t seed, std::vector<ExecutedStroke>* executed) {
  SimulatedRig rig(gate.workcell(), world, job.terrain, config.rig,
                   RandomStream(seed, StreamId("demo rig")));
  RigDriver driver(rig, gate, config.scan);
  const auto start = std::chrono::steady_clock::now();
  DemoRun run{.agent = agent.name()};
  LookAt(driver);
  run.run = RunClosedLoop(agent, model, gate, job, RandomStream(seed, StreamId("demo agent")),
                          [&](const Stroke& stroke) {
                            Drive drive = driver.Run(stroke);
                            if (!drive.finished()) throw Error("no stroke: " + drive.why());
                            if (executed)
                              executed->push_back(
                                  {rig.last_path(), std::move(drive.execution->record)});
                            return LookAt(driver);
                          });
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return run;
}

// What is to be expected of the agent, before it moves anything.
void AddVerdict(Agent& agent, const SandModel& model, const SafetyGate& gate, const ShapingJob& job,
                const DemoConfig& config, const SandModelConfig& sand, uint64_t seed, DemoReport& report) {
  const Verdict verdict =
      MakeVerdict(agent, model, LoadWorlds(config.verdict, sand), gate, job, seed, config.verdict);
  if (verdict.stopped) return;
  report.verdict = ToJson(verdict, job.goal, config.verdict);
  report.verdict_picture = DrawVerdict(verdict, job.terrain, job.goal);
}

// Joint curves end to end and how far the blade strayed sideways and in depth from its plan.
void AddMotion(const std::vector<ExecutedStroke>& executed, const ShapingRun& run,
               DemoReport& report) {
  double offset_s = 0;
  size_t index = 0;
  for (const ShapingStroke& stroke : run.strokes) {
    if (!stroke.verdict.accepted) continue;
    const ExecutedStroke& done = executed.at(index++);
    for (size_t i = 0; i < done.record.size(); ++i) {
      report.time_s.push_back(offset_s + done.record.time_s[i]);
      std::array<double, 6> joints;
      for (int k = 0; k < 6; ++k) joints[static_cast<size_t>(k)] = done.record.measured[i][k];
      report.joints_rad.push_back(joints);
    }
    offset_s = report.time_s.back();
    report.time_s.push_back(std::numeric_limits<double>::quiet_NaN());
    report.joints_rad.emplace_back();
    const ToolPath plan = SamplePath(stroke.stroke, 5e-4);
    for (const BladePose& pose : done.path) {
      double nearest_m = 1;
      for (const BladePose& p : plan)
        nearest_m =
            std::min(nearest_m, std::hypot(pose.x_m - p.x_m, pose.y_m - p.y_m, pose.z_m - p.z_m));
      report.tracking_error_mm = std::max(report.tracking_error_mm, 1e3 * nearest_m);
    }
  }
}

// The arm half-way through its first stroke.
void AddArmPicture(const Workcell& cell, const ShapingRun& run, const HeightMap& terrain,
                   DemoReport& report) {
  const auto accepted =
      std::ranges::find_if(run.strokes, [](auto& s) { return s.verdict.accepted; });
  if (accepted == run.strokes.end()) return;
  const StrokeMotion& motion = *accepted->verdict.motion;
  try {
    report.arm =
        ArmPicture(cell, terrain).Draw(motion.knots[(motion.path_begin + motion.path_end) / 2]);
  } catch (const Error& e) {
    report.arm_note = fmt::format("No picture of the arm: {}", e.what());
    spdlog::warn("{}", report.arm_note);
  }
}

// The accepted strokes as one plan and, where they are safe one after another on the bed as it was
// scanned first, as one program.
void AddPlan(const ShapingRun& run, const SafetyGate& gate, DemoReport& report) {
  for (const ShapingStroke& stroke : run.strokes) {
    if (stroke.verdict.accepted) report.plan.strokes.push_back(stroke.stroke);
  }
  const PlanVerdict verdict = CheckPlan(gate, report.plan.strokes, report.terrain);
  if (!verdict.accepted) {
    report.urscript_note = fmt::format(
        "There is no program: on the bed as it was scanned first the gate rejects the strokes "
        "({}).",
        fmt::join(verdict.reasons, "; "));
    return;
  }
  report.plan.seal = MakeSeal(report.plan.strokes, report.cell, report.terrain);
  report.urscript = MakeUrScript(report.plan.strokes, verdict, gate, "sandwright_demo");
  report.urscript_note =
      "The same strokes as a program for the CB3 controller; it went through the gate on its way "
      "out.";
}

// Frame, terrain and what the scan has to say.
void ScanFrame(const std::string& frame_file, const DemoConfig& config, DemoReport& report) {
  const DepthFrame frame = ReadDepthFrame(frame_file);
  const ScanResult scan =
      ScanDepth({&frame, 1}, config.camera, config.scan, {.sand_depth_m = config.sand_depth_m});
  if (!scan.accepted) throw Error(frame_file + " is not a bed of sand", scan.reasons);
  report.frame_name = std::filesystem::path(frame_file).filename().string();
  report.frame = DrawFrame(frame);
  report.terrain = scan.map;
  report.scan_summary = fmt::format(
      "The walls were found, {:.2f} degrees of tilt taken out; {:.1f} % of the pixels in the box "
      "had no reading; a single reading on the sand scatters by {:.2f} mm. The floor lies hidden "
      "under the sand: a mean depth of {:.0f} mm was given and sets the zero.",
      scan.tilt_removed_deg, 100 * scan.invalid_share, scan.noise_mm, 1e3 * config.sand_depth_m);
}

}  // namespace

DemoReport RunDemo(const std::string& frame_file, DemoConfig config, uint64_t seed, int threads) {
  Timings timings;
  DemoReport report;
  ScanFrame(frame_file, config, report);
  timings.Mark("scan");

  const double side_m = config.region_m, width_m = report.terrain.width_m(),
               depth_m = report.terrain.depth_m();
  const Region region{(width_m - side_m) / 2, (depth_m - side_m) / 2, side_m, side_m};
  report.region = region;
  report.goal = MakeGoal(ShapeFor(config, region), report.terrain, region, 1);
  report.cell = CellFor(report.terrain, config.camera);
  const SafetyGate gate(report.cell);
  SandModelConfig model_config;
  model_config.heightfield.threads = config.world.threads = threads;
  const auto model = LoadSandModel(config.model, model_config);
  const Heightfield world(config.world);
  report.model = fmt::format("Predictions come from the sand model \"{}\".", config.model);
  report.world = fmt::format(
      "The strokes are executed in another sand: a heightfield with a repose angle of {:.0f} "
      "degrees, which the model does not know, under a blade that follows its path as well as the "
      "simulated servos do.",
      config.world.repose_deg);
  const ShapingJob job{.terrain = report.terrain,
                       .goal = report.goal,
                       .region = region,
                       .max_strokes = static_cast<int>(config.max_strokes),
                       .speed_mps = config.speed_mps};
  timings.Mark("goal, cell and models");

  const AgentOptions options{.model = *model,
                             .planners = config.planners,
                             .speed_mps = config.speed_mps,
                             .gate = &gate};
  std::vector<ExecutedStroke> executed;
  for (const std::string& name : {config.agent, std::string("greedy"), std::string("random")}) {
    if (!report.runs.empty() && name == config.agent) continue;  // no rival beside itself
    const auto agent = LoadAgent(name, options);
    const bool first = report.runs.empty();
    if (first) {
      AddVerdict(*agent, *model, gate, job, config, model_config, seed, report);
      timings.Mark("verdict");
    }
    report.runs.push_back(
        RunAgent(*agent, *model, gate, job, world, config, seed, first ? &executed : nullptr));
    timings.Mark(agent->name() + ": strokes chosen, gated, executed, rescanned");
    report.stopped = report.runs.back().run.stopped;
    if (report.stopped) break;
  }
  const ShapingRun& run = report.runs.front().run;
  if (!report.verdict.is_null() && !run.stopped)
    report.outcome = CompareWithVerdict(report.verdict, report.goal, run.final_error_m());
  AddMotion(executed, run, report);
  AddArmPicture(report.cell, run, report.terrain, report);
  timings.Mark("picture of the arm");
  AddPlan(run, gate, report);
  timings.Mark("plan and URScript");
  report.timings_s = timings.parts();
  return report;
}

nlohmann::json DemoJson(const DemoReport& report) {
  nlohmann::json json = {{"frame", report.frame_name},
                         {"stopped", report.stopped},
                         {"tracking_error_mm", report.tracking_error_mm},
                         {"verdict", report.verdict},
                         {"outcome", report.outcome}};
  for (const DemoRun& run : report.runs) {
    nlohmann::json strokes = nlohmann::json::array();
    for (const ShapingStroke& stroke : run.run.strokes)
      strokes.push_back({{"accepted", stroke.verdict.accepted},
                         {"reasons", stroke.verdict.reasons},
                         {"in_goal_mean_diff_mm", 1e3 * stroke.goal_error_m},
                         {"choose_ms", stroke.choose_ms},
                         {"gate_ms", stroke.gate_ms},
                         {"predict_ms", stroke.predict_ms}});
    json["agents"].push_back({{"agent", run.agent},
                              {"in_goal_mean_diff_start_mm", 1e3 * run.run.start_error_m},
                              {"in_goal_mean_diff_mm", 1e3 * run.run.final_error_m()},
                              {"rejected_strokes", run.run.rejected()},
                              {"seconds", run.seconds},
                              {"strokes", strokes}});
  }
  for (const auto& [part, seconds] : report.timings_s)
    json["timings_s"].push_back({{"part", part}, {"seconds", seconds}});
  return json;
}

}  // namespace sandwright
