#include "agents/verdict.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "data/base/error.h"
#include "data/base/sha256.h"
#include "data/picture.h"
#include "data/task.h"
#include "robot_model/plan.h"
#include "robot_model/stroke_motion.h"

namespace sandwright {
namespace {

constexpr double kVolume_m = 0.0005;  // a mean height less than this is no lack of sand
constexpr double kPicture_m = 0.012;

struct ReasonName {
  MissReason reason;
  const char* key;
  const char* words;
  cv::Vec3b colour;  // BGR
};
constexpr size_t kReasons = 5;
const std::array<ReasonName, kReasons> kReasonNames = {{
    {MissReason::kReach, "out_of_reach", "out of the arm's reach", {60, 60, 60}},
    {MissReason::kSlope, "steep", "steeper than sand stands", {40, 40, 200}},
    {MissReason::kNarrow, "narrow", "narrower than the blade", {200, 60, 160}},
    {MissReason::kVolume, "volume", "too much or too little sand", {200, 130, 30}},
    {MissReason::kStrokes, "strokes", "more strokes would help", {30, 160, 220}},
}};

// The arm's way: camera, entry, stroke, exit, camera, and a look.
double ArmSeconds(const ShapingRun& run, const SafetyGate& gate, double look_s) {
  const JointAngles camera = gate.workcell().camera_pose();
  const MotionSettings& limits = gate.workcell().motion;
  double knots = 0, seconds = 0;
  for (const ShapingStroke& stroke : run.strokes) {
    if (!stroke.verdict.accepted) continue;
    const std::vector<JointAngles>& motion = stroke.verdict.motion->knots;
    knots += static_cast<double>(TransferKnots(camera, motion.front(), limits).size() + motion.size() +
                                 TransferKnots(motion.back(), camera, limits).size());
    seconds += look_s;
  }
  return seconds + knots * StrokeMotion::kPeriod_s;
}

HeightMap MeanEnd(std::span<const WorldOutcome> worlds) {
  HeightMap mean = worlds.front().end;
  for (size_t i = 0; i < mean.size(); ++i) {
    double sum_m = 0;
    for (const WorldOutcome& world : worlds) sum_m += world.end.height_m[i];
    mean.height_m[i] = static_cast<float>(sum_m / static_cast<double>(worlds.size()));
  }
  return mean;
}

std::vector<MissReason> WhyMissed(const HeightMap& end, const HeightMap& goal, const Feasibility& found,
                                  std::span<const uint8_t> faults, double miss_m) {
  const double counted = static_cast<double>(std::ranges::count(goal.mask, 1));
  const double missing_m = found.volume_missing_m3 / (counted * goal.cell_size_m * goal.cell_size_m);
  std::vector<MissReason> why(goal.size(), MissReason::kNotCounted);
  for (size_t i = 0; i < goal.size(); ++i) {
    if (!goal.mask[i]) continue;
    const double off_m = end.height_m[i] - goal.height_m[i];
    const bool short_of_sand = std::abs(missing_m) > kVolume_m && (off_m < 0) == (missing_m > 0);
    why[i] = std::abs(off_m) <= miss_m     ? MissReason::kHit
             : (faults[i] & kOutOfReach)   ? MissReason::kReach
             : (faults[i] & kTooSteep)     ? MissReason::kSlope
             : (faults[i] & kTooNarrow)    ? MissReason::kNarrow
             : (faults[i] & kBelowFloor)   ? MissReason::kVolume
             : short_of_sand               ? MissReason::kVolume
                                           : MissReason::kStrokes;
  }
  return why;
}

// The cells that count, with a rim.
CellRect Counted(const HeightMap& goal) {
  constexpr int kRim = 5;
  CellRect rect{goal.rows, goal.columns, 0, 0};
  for (int row = 0; row < goal.rows; ++row) {
    for (int column = 0; column < goal.columns; ++column) {
      if (!goal.mask[goal.Index(row, column)]) continue;
      rect = {std::min(rect.row0, row - kRim), std::min(rect.column0, column - kRim),
              std::max(rect.row1, row + 1 + kRim), std::max(rect.column1, column + 1 + kRim)};
    }
  }
  return {std::max(rect.row0, 0), std::max(rect.column0, 0), std::min(rect.row1, goal.rows),
          std::min(rect.column1, goal.columns)};
}

cv::Mat DrawReasons(const Verdict& verdict, const HeightMap& goal, const CellRect& part, int scale) {
  cv::Mat image(part.rows() * scale, part.columns() * scale, CV_8UC3);
  for (int row = 0; row < part.rows(); ++row) {
    for (int column = 0; column < part.columns(); ++column) {
      const MissReason why = verdict.why[goal.Index(part.row0 + row, part.column0 + column)];
      cv::Vec3b colour = why == MissReason::kHit ? cv::Vec3b(235, 245, 235) : cv::Vec3b(200, 200, 200);
      for (const ReasonName& name : kReasonNames) {
        if (name.reason == why) colour = name.colour;
      }
      image(cv::Rect(column * scale, (part.rows() - 1 - row) * scale, scale, scale)) = cv::Scalar(colour);
    }
  }
  return image;
}

}  // namespace

ErrorInterval IntervalOf(std::span<const double> world_error_m, const VerdictConfig& config) {
  SAND_CHECK(!world_error_m.empty());
  double sum_m = 0;
  for (const double error_m : world_error_m) sum_m += error_m;
  return {sum_m / static_cast<double>(world_error_m.size()),
          config.low_factor * std::ranges::min(world_error_m),
          config.high_factor * std::ranges::max(world_error_m)};
}

double ErrorAsScanned(const HeightMap& scan, const HeightMap& end, const HeightMap& goal) {
  SAND_CHECK(end.SameGrid(scan) && goal.SameGrid(scan), end.rows, scan.rows);
  constexpr double kSmooth_m = 0.008, kChanged_m = 0.001;
  HeightMap smooth = scan;
  cv::Mat image(smooth.rows, smooth.columns, CV_32F, smooth.height_m.data());
  cv::GaussianBlur(image, image, {}, kSmooth_m / scan.cell_size_m, 0, cv::BORDER_REFLECT);
  double sum_m = 0, counted = 0;
  for (size_t i = 0; i < end.size(); ++i) {
    if (!goal.mask[i]) continue;
    // The roughness of another cell: what the model did leave of this one's own must not be counted twice.
    const size_t other = end.size() - 1 - i;
    const bool changed = std::abs(end.height_m[i] - scan.height_m[i]) > kChanged_m;
    const double rough_m = changed ? scan.height_m[other] - smooth.height_m[other] : 0;
    sum_m += std::abs(end.height_m[i] + rough_m - goal.height_m[i]);
    ++counted;
  }
  return sum_m / counted;
}

Verdict MakeVerdict(Agent& agent, const SandModel& model, std::span<const std::unique_ptr<SandModel>> worlds,
                    const SafetyGate& gate, const ShapingJob& job, uint64_t seed, const VerdictConfig& config) {
  Verdict verdict{.start_error_m = GoalError(job.terrain, job.goal), .goal_id = GoalId(job.goal)};
  std::vector<double> errors_m;
  double strokes = 0;
  SAND_CHECK(worlds.size() == config.worlds.size(), worlds.size(), config.worlds.size());
  for (size_t w = 0; w < worlds.size(); ++w) {
    const std::optional<double> cell_m = worlds[w]->cell_size_m();
    if (cell_m && std::abs(*cell_m - job.terrain.cell_size_m) > 1e-9) {
      spdlog::info("the verdict goes without {}: it works on cells of {:g} mm", config.worlds[w], 1e3 * *cell_m);
      continue;
    }
    HeightMap bed = job.terrain;
    const ShapingRun run =
        RunClosedLoop(agent, model, gate, job, RandomStream(seed, StreamId("verdict")), [&](const Stroke& stroke) {
          SandState state = worlds[w]->Start(bed, 0);
          worlds[w]->Apply({&state, 1}, {&stroke, 1});
          return bed = state.map();
        });
    if (run.stopped) return verdict.stopped = true, verdict;
    errors_m.push_back(ErrorAsScanned(job.terrain, bed, job.goal));
    verdict.worlds.push_back({config.worlds[w], errors_m.back(), static_cast<int>(run.strokes.size()),
                              run.rejected(), ArmSeconds(run, gate, config.look_s), bed});
    strokes += static_cast<double>(run.strokes.size());
    verdict.arm_s += verdict.worlds.back().arm_s;
  }
  if (errors_m.empty())
    throw Error(fmt::format("verdict.worlds: none of them works on cells of {:g} mm", 1e3 * job.terrain.cell_size_m));
  const auto count = static_cast<double>(errors_m.size());
  verdict.error = IntervalOf(errors_m, config);
  verdict.strokes = static_cast<int>(std::lround(strokes / count));
  verdict.arm_s /= count;
  verdict.end = MeanEnd(verdict.worlds);
  const ReachMap& reach = gate.reach();
  verdict.goal = JudgeGoal(job.goal, job.terrain, config.goal, &reach);
  const std::vector<uint8_t> faults = GoalFaults(job.goal, config.goal, &reach);
  verdict.why = WhyMissed(verdict.end, job.goal, verdict.goal, faults, config.miss_m);
  return verdict;
}

std::string GoalId(const HeightMap& goal) {
  HeightMap counted = goal;
  for (size_t i = 0; i < goal.size(); ++i) {
    if (!goal.mask.empty() && !goal.mask[i]) counted.height_m[i] = -1;
  }
  return Sha256Hex(TerrainHash(counted) + std::string(goal.mask.begin(), goal.mask.end()));
}

nlohmann::json ToJson(const Verdict& verdict, const HeightMap& goal, const VerdictConfig& config) {
  const auto counted = static_cast<double>(std::ranges::count(goal.mask, 1));
  nlohmann::json json = {{"start_error_mm", 1e3 * verdict.start_error_m},
                         {"expected_error_mm", 1e3 * verdict.error.expected_m},
                         {"low90_mm", 1e3 * verdict.error.low90_m},
                         {"high90_mm", 1e3 * verdict.error.high90_m},
                         {"low_factor", config.low_factor},
                         {"high_factor", config.high_factor},
                         {"strokes", verdict.strokes},
                         {"arm_minutes", verdict.arm_s / 60},
                         {"goal", ToJson(verdict.goal)},
                         {"goal_id", verdict.goal_id}};
  for (const WorldOutcome& world : verdict.worlds)
    json["worlds"].push_back({{"world", world.world}, {"error_mm", 1e3 * world.error_m}, {"strokes", world.strokes},
                              {"rejected_strokes", world.rejected}, {"arm_minutes", world.arm_s / 60}});
  for (const ReasonName& name : kReasonNames) {
    double cells = 0, error_m = 0;
    for (size_t i = 0; i < goal.size(); ++i) {
      if (verdict.why[i] != name.reason) continue;
      ++cells;
      error_m += std::abs(verdict.end.height_m[i] - goal.height_m[i]);
    }
    json["misses"][name.key] = {{"share", cells / counted}, {"of_error_mm", 1e3 * error_m / counted}};
  }
  return json;
}

nlohmann::json CompareWithVerdict(const nlohmann::json& verdict, const HeightMap& goal, double end_error_m) {
  for (const char* key : {"goal_id", "expected_error_mm", "low90_mm", "high90_mm"}) {
    if (!verdict.contains(key)) throw Error(fmt::format("the verdict has no {}: is it from plan --verdict?", key));
  }
  if (verdict["goal_id"] != GoalId(goal)) throw Error("the verdict was made for another goal");
  const double error_mm = 1e3 * end_error_m;
  return {{"expected_error_mm", verdict["expected_error_mm"]},
          {"low90_mm", verdict["low90_mm"]},
          {"high90_mm", verdict["high90_mm"]},
          {"in_goal_mean_diff_mm", error_mm},
          {"inside", error_mm >= verdict["low90_mm"] && error_mm <= verdict["high90_mm"]}};
}

cv::Mat DrawVerdict(const Verdict& verdict, const HeightMap& terrain, const HeightMap& goal) {
  constexpr int kPanel_px = 420, kGap_px = 10, kCaption_px = 26, kLine_px = 22;
  const CellRect part = Counted(goal);
  const int scale = std::max(1, kPanel_px / std::max(part.rows(), part.columns()));
  const auto against_goal = [&](const HeightMap& map) {
    return DrawDifference(Crop(map, part), Crop(goal, part), kPicture_m, scale);
  };
  const std::pair<std::string, cv::Mat> panels[] = {{"now - goal, +-12 mm", against_goal(terrain)},
                                                    {"expected end - goal", against_goal(verdict.end)},
                                                    {"where it will miss", DrawReasons(verdict, goal, part, scale)}};
  const int across = part.columns() * scale + kGap_px, down = kCaption_px + part.rows() * scale;
  cv::Mat sheet(down + static_cast<int>(kReasons) * kLine_px + kGap_px, 3 * across + kGap_px, CV_8UC3,
                cv::Scalar(255, 255, 255));
  const auto write = [&](const std::string& text, int x, int y) {
    cv::putText(sheet, text, {x, y}, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(40, 40, 40), 1, cv::LINE_AA);
  };
  for (int i = 0; i < 3; ++i) {
    const auto& [caption, image] = panels[i];
    const int x = kGap_px + i * across;
    write(caption, x, kCaption_px - 8);
    image.copyTo(sheet(cv::Rect(x, kCaption_px, image.cols, image.rows)));
  }
  for (size_t k = 0; k < kReasons; ++k) {
    const int x = kGap_px + 2 * across, y = down + static_cast<int>(k + 1) * kLine_px - 4;
    sheet(cv::Rect(x, y - 11, 12, 12)) = cv::Scalar(kReasonNames[k].colour);
    write(kReasonNames[k].words, x + 20, y);
  }
  return sheet;
}

}  // namespace sandwright
