// Before anything moves: how near to the goal an agent will come, where it will miss and why, and what it
// takes of the arm's time. The same agent plays the task in several sands, so that what one model does not
// know another may; how far reality lies outside of their range was measured (docs/verdict.md).
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "agents/closed_loop.h"
#include "env/feasible_goal.h"

namespace sandwright {

struct VerdictConfig {
  std::vector<std::string> worlds = {"heightfield", "fast", "default"};
  // `verdict_calibration` of tests/benchmarks; docs/results/verdict.json.
  double low_factor = 1, high_factor = 1.15;
  double miss_m = 0.002;
  double look_s = 2;
  FeasibilityConfig goal;  // by which cells are told that no stroke can make

  void Fields(FieldList& f) {
    f.Add("worlds", worlds, "sand models that the agent's strokes are executed in; those of other cells are left out");
    f.Add("low_factor", low_factor, "the 90 % interval begins at this share of the least error in any world [1]", 0, 2);
    f.Add("high_factor", high_factor, "and ends at this multiple of the largest [1]", 0, 10);
    f.Add("miss_m", miss_m, "a cell that ends further than this from the goal is a miss [m]", 0, 0.1);
    f.Add("look_s", look_s, "time that a scan takes between two strokes [s]", 0, 600);
    f.Section("goal", goal);
  }
};

struct ErrorInterval {
  double expected_m = 0, low90_m = 0, high90_m = 0;
  bool holds(double error_m) const { return error_m >= low90_m && error_m <= high90_m; }
};
// Of the errors in at least one world.
ErrorInterval IntervalOf(std::span<const double> world_error_m, const VerdictConfig& config);

// Goal error of a bed that a model foresees, as a scan will see it [m]: what the blade has smoothed in the model is as
// rough in the sand as the first scan is.
double ErrorAsScanned(const HeightMap& scan, const HeightMap& end, const HeightMap& goal);

// Why a cell will be missed; the first that applies.
enum class MissReason : uint8_t { kHit, kReach, kSlope, kNarrow, kVolume, kStrokes, kNotCounted };

struct WorldOutcome {
  std::string world;
  double error_m = 0;  // ErrorAsScanned
  int strokes = 0, rejected = 0;
  double arm_s = 0;  // from camera pose to camera pose, with a look after each stroke
  HeightMap end;
};

struct Verdict {
  double start_error_m = 0;
  ErrorInterval error = {};
  int strokes = 0;   // mean over the worlds, rounded
  double arm_s = 0;  // mean over the worlds
  Feasibility goal = {};
  std::vector<WorldOutcome> worlds = {};
  HeightMap end = {};                // mean over the worlds
  std::vector<MissReason> why = {};  // [cells]
  std::string goal_id = {};          // GoalId
  bool stopped = false;              // by Ctrl-C: worth nothing
};

// Plays `job` with rescans after each stroke in each of `worlds` (config.worlds by name); the agent plans with the
// `model` that it was loaded with. Throws Error where none of the worlds fits the terrain's cells, and as
// RunClosedLoop.
Verdict MakeVerdict(Agent& agent, const SandModel& model, std::span<const std::unique_ptr<SandModel>> worlds,
                    const SafetyGate& gate, const ShapingJob& job, uint64_t seed, const VerdictConfig& config);

// Identity of a goal: grid, mask and the heights that count.
std::string GoalId(const HeightMap& goal);

nlohmann::json ToJson(const Verdict& verdict, const HeightMap& goal, const VerdictConfig& config);

// How it came out: the keys of the interval, with the error at the end and whether it lies inside. Throws Error
// where `verdict` (ToJson's) is none or of another goal.
nlohmann::json CompareWithVerdict(const nlohmann::json& verdict, const HeightMap& goal, double end_error_m);

// Start and expected end against the goal (+-12 mm), and the misses in the colours of their reasons.
cv::Mat DrawVerdict(const Verdict& verdict, const HeightMap& terrain, const HeightMap& goal);

}  // namespace sandwright
