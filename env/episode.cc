#include "env/episode.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "data/base/parallel.h"
#include "robot_model/safety_gate.h"

namespace sandwright {
namespace {

constexpr double kChanged_m = 0.002;  // a cell that changed by more counts as changed

SandState Look(const SandState& sand, const SensorConfig& sensor, RandomStream& stream) {
  return sensor.perfect() ? sand : SandState(Sense(sand.map(), sensor, stream));
}

// The stroke that the blade makes where `stroke` is asked for.
Stroke Track(const Stroke& stroke, double error_m, RandomStream& stream) {
  if (error_m == 0) return stroke;
  Eigen::Vector3d off;
  for (double& along : off) along = error_m * stream.Normal();
  Stroke tracked = stroke;
  for (Eigen::Vector3d& point : tracked.control_points_m) point += off;
  return tracked;
}

// A gate for another blade or box would judge strokes that are not the ones executed.
void CheckGateFits(const World& world, const HeightMap& map) {
  const Workcell& cell = world.gate->workcell();
  const Blade &gated = cell.tool.blade, &sand = world.sand.blade();
  if (gated.width_m != sand.width_m || gated.thickness_m != sand.thickness_m)
    throw Error(fmt::format(
        "the workcell's blade is {} x {} m, the sand model's {} x {} m; they must be equal",
        gated.width_m, gated.thickness_m, sand.width_m, sand.thickness_m));
  if (std::abs(cell.box.width_m - map.width_m()) > 1e-6 ||
      std::abs(cell.box.depth_m - map.depth_m()) > 1e-6)
    throw Error(fmt::format(
        "the workcell's box is {:.4g} x {:.4g} m, the terrain {:.4g} x {:.4g} m; they must "
        "be equal",
        cell.box.width_m, cell.box.depth_m, map.width_m(), map.depth_m()));
}

// [low, low + extent) around `middle` along one axis, moved inside [0, wall] where it fits.
double Corner(double middle_m, double extent_m, double wall_m) {
  if (extent_m >= wall_m) return (wall_m - extent_m) / 2;
  return std::clamp(middle_m - extent_m / 2, 0.0, wall_m - extent_m);
}

void EndIfDue(const EpisodeConfig& config, EpisodeState& episode) {
  episode.terminated = episode.goal_error_m.back() <= config.success_error_m ||
                       episode.budget_used >= episode.task->max_strokes ||
                       episode.rejected_in_a_row >= config.max_rejected_in_a_row;
  episode.truncated = !episode.terminated && config.truncate_after_strokes > 0 &&
                      episode.strokes() >= config.truncate_after_strokes;
}

StrokeResult DecodeAndGate(const World& world, const EpisodeConfig& config,
                           const EpisodeState& episode, const Action& action) {
  const HeightMap& sensed = episode.sensed.map();
  StrokeResult result;
  result.stroke =
      DecodeAction(action, sensed, episode.region, world.sand.blade(), config.speed_mps);
  if (!world.gate) return result;
  CheckGateFits(world, sensed);
  GateVerdict verdict = world.gate->Check(result.stroke, sensed, GateSampling::kCoarse);
  SAND_CHECK(verdict.accepted == verdict.reasons.empty(), verdict.accepted);
  result.rejected_for = std::move(verdict.reasons);
  return result;
}

void RewardAndSense(const EpisodeConfig& config, SandState after, EpisodeState& episode,
                    StrokeResult& result) {
  ++episode.budget_used;
  if (result.accepted()) {
    result.reward =
        StrokeReward(config.reward, episode.sand.map(), after.map(), episode.task->goal);
    episode.sand = std::move(after);
    episode.moved_volume_m3 += result.outcome.moved_volume_m3;
    episode.rejected_in_a_row = 0;
  } else {
    result.reward = RejectedReward(config.reward);
    ++episode.rejected_in_a_row;
    ++episode.rejected_strokes;
  }
  episode.sensed = Look(episode.sand, config.sensor, episode.noise);
  episode.episode_return += result.reward.total();
  episode.goal_error_m.push_back(GoalError(episode.sand.map(), episode.task->goal));
  EndIfDue(config, episode);
}

}  // namespace

Region RegionOf(const Task& task, const EpisodeConfig& config) {
  const HeightMap& goal = task.goal;
  const double width_m = config.region_width_m > 0 ? config.region_width_m : goal.width_m();
  const double depth_m = config.region_depth_m > 0 ? config.region_depth_m : goal.depth_m();
  CellRect counted{goal.rows, goal.columns, 0, 0};
  for (int row = 0; row < goal.rows; ++row) {
    for (int column = 0; column < goal.columns; ++column) {
      if (!goal.mask[goal.Index(row, column)]) continue;
      counted = {std::min(counted.row0, row), std::min(counted.column0, column),
                 std::max(counted.row1, row + 1), std::max(counted.column1, column + 1)};
    }
  }
  const double cell = goal.cell_size_m;
  if (counted.columns() * cell > width_m + 1e-9 || counted.rows() * cell > depth_m + 1e-9)
    throw Error(
        fmt::format("the goal counts over {:.3f} x {:.3f} m; the region (region_width_m, "
                    "region_depth_m) is {:.3f} x {:.3f} m and must hold it",
                    counted.columns() * cell, counted.rows() * cell, width_m, depth_m));
  return {Corner((counted.column0 + counted.column1) * cell / 2, width_m, goal.width_m()),
          Corner((counted.row0 + counted.row1) * cell / 2, depth_m, goal.depth_m()), width_m,
          depth_m};
}

EpisodeState StartEpisode(const SandModel& model, std::shared_ptr<const Task> task, const EpisodeConfig& config,
                          RandomStream noise, int budget_used) {
  SAND_CHECK(budget_used >= 0 && budget_used < task->max_strokes, budget_used, task->max_strokes);
  const SandState sand = model.Start(task->terrain, RandomStream(noise).Next64());
  SandState sensed = Look(sand, config.sensor, noise);
  EpisodeState episode{.task = task,
                       .region = RegionOf(*task, config),
                       .sand = sand,
                       .sensed = std::move(sensed),
                       .noise = noise,
                       .budget_used = budget_used,
                       .goal_error_m = {GoalError(sand.map(), task->goal)}};
  return episode;
}

EpisodeState ContinueEpisode(std::shared_ptr<const Task> task, const EpisodeConfig& config, SandState bed,
                             std::vector<double> goal_error_m, RandomStream noise) {
  SAND_CHECK(!goal_error_m.empty());
  SandState sensed = Look(bed, config.sensor, noise);
  EpisodeState episode{.task = task,
                       .region = RegionOf(*task, config),
                       .sand = std::move(bed),
                       .sensed = std::move(sensed),
                       .noise = noise,
                       .budget_used = static_cast<int>(goal_error_m.size()) - 1,
                       .goal_error_m = std::move(goal_error_m)};
  if (episode.strokes() > 0) EndIfDue(config, episode);
  return episode;
}

TaskView View(const EpisodeState& episode, const SafetyGate* gate) {
  return {.sensed = episode.sensed.map(),
          .goal = episode.task->goal,
          .region = episode.region,
          .strokes_used = episode.budget_used,
          .max_strokes = episode.task->max_strokes,
          .rejected_in_a_row = episode.rejected_in_a_row,
          .gate = gate};
}

std::vector<std::optional<StrokeResult>> StepEpisodes(const World& world,
                                                      const EpisodeConfig& config,
                                                      std::span<EpisodeState> episodes,
                                                      std::span<const Action> actions) {
  SAND_CHECK(episodes.size() == actions.size(), episodes.size(), actions.size());
  const int count = static_cast<int>(episodes.size());
  std::vector<std::optional<StrokeResult>> results(episodes.size());
  ParallelFor(count, world.threads, [&](int n) {
    const auto i = static_cast<size_t>(n);
    if (!episodes[i].ended()) results[i] = DecodeAndGate(world, config, episodes[i], actions[i]);
  });

  // One batch of the accepted strokes, so that a learned model evaluates them together.
  std::vector<size_t> accepted;
  std::vector<SandState> states;
  std::vector<Stroke> strokes;
  for (size_t i = 0; i < results.size(); ++i) {
    if (!results[i] || !results[i]->accepted()) continue;
    accepted.push_back(i);
    states.push_back(episodes[i].sand);
    strokes.push_back(
        Track(results[i]->stroke, config.tracking_error_m, episodes[i].noise));
  }
  const std::vector<Outcome> outcomes = world.sand.Apply(states, strokes);
  std::vector<SandState> after;
  for (const EpisodeState& episode : episodes) after.push_back(episode.sand);
  for (size_t k = 0; k < accepted.size(); ++k) {
    after[accepted[k]] = std::move(states[k]);
    results[accepted[k]]->outcome = outcomes[k];
  }

  ParallelFor(count, world.threads, [&](int n) {
    const auto i = static_cast<size_t>(n);
    if (results[i]) RewardAndSense(config, std::move(after[i]), episodes[i], *results[i]);
  });
  return results;
}

std::map<std::string, double> EpisodeMetrics(const EpisodeState& episode,
                                             const EpisodeConfig& config) {
  const HeightMap &start = episode.task->terrain, &goal = episode.task->goal,
                  &end = episode.sand.map();
  double square_sum = 0, counted = 0, changed = 0;
  for (size_t i = 0; i < end.size(); ++i) {
    const double h = end.height_m[i];
    const double error = h - (goal.mask[i] ? goal.height_m[i] : start.height_m[i]);
    square_sum += error * error;
    counted += goal.mask[i] != 0;
    changed += goal.mask[i] && std::abs(h - start.height_m[i]) > kChanged_m;
  }
  const auto error_mm = [&](size_t strokes) {
    return 1e3 * episode.goal_error_m[std::min(strokes, episode.goal_error_m.size() - 1)];
  };
  return {{"in_goal_mean_diff_start_mm", error_mm(0)},
          {"in_goal_mean_diff_mm", 1e3 * episode.goal_error_m.back()},
          {"rmse_mm", 1e3 * std::sqrt(square_sum / static_cast<double>(end.size()))},
          {"in_goal_cells_changed", changed / counted},
          {"strokes", episode.strokes()},
          {"rejected_strokes", episode.rejected_strokes},
          {"success", episode.goal_error_m.back() <= config.success_error_m ? 1 : 0},
          {"moved_volume_cm3", 1e6 * episode.moved_volume_m3},
          {"error_after_5_mm", error_mm(5)},
          {"error_after_10_mm", error_mm(10)},
          {"error_after_20_mm", error_mm(20)}};
}

}  // namespace sandwright
