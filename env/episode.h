// One try at a task, stroke by stroke: the step that training and evaluation share.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/base/random.h"
#include "data/task.h"
#include "env/agent.h"
#include "env/reward.h"
#include "env/sand_model.h"
#include "env/sensor.h"

namespace sandwright {

class SafetyGate;

// What executes strokes. The references must outlive their user.
struct World {
  const SandModel& sand;
  // None: no arm, every stroke is executed as far as the box allows.
  const SafetyGate* gate = nullptr;
  int threads = 1;  // for decoding, gate and sensing; results do not depend on it
};

struct EpisodeConfig {
  double region_width_m = 0, region_depth_m = 0;
  double speed_mps = 0.1;
  double success_error_m = 0.002;
  double tracking_error_m = 0;
  int64_t max_rejected_in_a_row = 3;
  int64_t truncate_after_strokes = 0;
  SensorConfig sensor = {};
  RewardConfig reward = {};

  void Fields(FieldList& f) {
    f.Add("region_width_m", region_width_m, "extent of the region along x [m]; 0: the whole map", 0,
          5);
    f.Add("region_depth_m", region_depth_m, "extent of the region along y [m]; 0: the whole map", 0,
          5);
    f.Add("speed_mps", speed_mps, "speed of the blade [m/s]", 0.005, 1);
    f.Add("success_error_m", success_error_m, "goal error at which a task is done [m]", 0, 0.1);
    f.Add("tracking_error_m", tracking_error_m,
          "sd of how far an executed stroke lies off its command along x, y and z [m]", 0, 0.05);
    f.Add("max_rejected_in_a_row", max_rejected_in_a_row, "rejected strokes in a row that end it",
          1, 1000);
    f.Add("truncate_after_strokes", truncate_after_strokes,
          "limit from outside the task [strokes]; 0: none", 0, 100000);
    f.Section("sensor", sensor);
    f.Section("reward", reward);
  }
};

// Everything that changes in the course of an episode.
struct EpisodeState {
  std::shared_ptr<const Task> task;
  Region region;
  SandState sand;    // the truth
  SandState sensed;  // what an agent sees of it
  RandomStream noise;  // of sensor and arm
  int budget_used = 0;  // of task->max_strokes; counts rejected strokes
  int rejected_in_a_row = 0;
  int rejected_strokes = 0;
  double moved_volume_m3 = 0;
  double episode_return = 0;
  std::vector<double> goal_error_m;  // true: at the start and after each stroke
  bool terminated = false, truncated = false;

  bool ended() const { return terminated || truncated; }
  int strokes() const { return static_cast<int>(goal_error_m.size()) - 1; }  // of this episode
};

// What one stroke did.
struct StrokeResult {
  Stroke stroke;
  std::vector<std::string> rejected_for;  // the gate's reasons; empty: executed
  Outcome outcome;                        // of an executed stroke
  Reward reward;
  bool accepted() const { return rejected_for.empty(); }
};

// The part of the box that actions and observations are relative to: config's extent around the
// middle of the goal's mask, moved inside the walls where it fits there; the whole map for extent
// 0. Throws Error where the mask reaches beyond it.
Region RegionOf(const Task& task, const EpisodeConfig& config);

// A bed of `model` for the task's terrain. `budget_used` > 0 starts with that part of the budget gone. The task must pass CheckTask.
EpisodeState StartEpisode(const SandModel& model, std::shared_ptr<const Task> task, const EpisodeConfig& config,
                          RandomStream noise, int budget_used = 0);

// An episode that goes on after strokes of its own, all of them accepted: `bed` is what they left, `goal_error_m` holds
// the error at the start and after each. `noise` is of the look that comes now. The moved volume starts at 0.
EpisodeState ContinueEpisode(std::shared_ptr<const Task> task, const EpisodeConfig& config, SandState bed,
                             std::vector<double> goal_error_m, RandomStream noise);

// Points into `episode`.
TaskView View(const EpisodeState& episode, const SafetyGate* gate = nullptr);

// One stroke of each episode: decode, gate, arm, sand, sense, reward. Episodes that have ended are left
// alone and give no result. Terminated: success, budget used up, or too many rejected strokes in a
// row; truncated: only EpisodeConfig::truncate_after_strokes. A rejected stroke uses up budget and
// moves no sand. Throws Error before anything changes where an action is not in [-1, 1], or where
// the gate's blade or box is another than the sand's.
std::vector<std::optional<StrokeResult>> StepEpisodes(const World& world,
                                                      const EpisodeConfig& config,
                                                      std::span<EpisodeState> episodes,
                                                      std::span<const Action> actions);

// The figures of an episode as it stands:
//   in_goal_mean_diff_start_mm, in_goal_mean_diff_mm  mean |height - goal| over the mask
//   rmse_mm               over the whole box; where the goal does not count, against the start
//   in_goal_cells_changed share of the mask's cells that changed by more than 2 mm
//   strokes, rejected_strokes, success (0 or 1), moved_volume_cm3
//   error_after_5_mm, error_after_10_mm, error_after_20_mm  after that many strokes or at the end
std::map<std::string, double> EpisodeMetrics(const EpisodeState& episode,
                                             const EpisodeConfig& config);

}  // namespace sandwright
