#include "env/stress_rollouts.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>

#include "data/base/parallel.h"
#include "data/base/random.h"
#include "data/base/stop.h"
#include "data/excavation.h"
#include "env/random_strokes.h"
#include "env/terrain_generator.h"

namespace sandwright {
namespace {

constexpr double kBed_m = 0.3, kBoxWidth_m = 1.2, kBoxDepth_m = 0.8;
constexpr double kAnyCell_m = 0.005;  // of a model that is bound to none
constexpr std::array<std::string_view, 7> kBeds = {
    "hills", "cliff", "film on the floor", "flat", "ridges", "piles at walls", "half bare"};

double RadiansOf(double degrees) { return degrees * std::numbers::pi / 180; }

double CellSize(const SandModel& model) { return model.cell_size_m().value_or(kAnyCell_m); }

HeightMap MakeBed(std::string_view kind, double cell_size_m, double repose_deg,
                  RandomStream& stream) {
  const int n = WholeCells(kBed_m, cell_size_m, "the bed");
  if (kind == "hills")
    return GenerateTerrain({.amplitude_m = 0.02, .shapes = 2, .repose_deg = repose_deg}, n, n,
                           cell_size_m, stream);
  const int middle = n / 4 + static_cast<int>(stream.Index(static_cast<uint64_t>(n / 2)));
  const int pile = std::max(n / 15, 1);
  HeightMap bed(n, n, cell_size_m);
  for (int row = 0; row < n; ++row) {
    for (int column = 0; column < n; ++column) {
      float& height_m = bed.At(row, column);
      if (kind == "cliff") height_m = column < middle ? 0.02f : 0.12f;
      if (kind == "film on the floor") height_m = 0.004f;
      if (kind == "flat") height_m = 0.02f;
      if (kind == "ridges") height_m = column % 4 == 0 ? 0.06f : 0.02f;
      if (kind == "piles at walls")
        height_m = (row < pile && column < pile) || column >= n - pile ? 0.12f : 0.02f;
      if (kind == "half bare") height_m = row < middle ? 0.0f : 0.06f;
    }
  }
  return bed;
}

// The third that is shifted crosses walls, corners and the floor.
Stroke DrawHardStroke(const HeightMap& bed, RandomStream& stream) {
  Stroke stroke =
      DrawStroke({.wall_margin_m = 0, .floor_margin_m = 0, .deepest_m = 0.06}, bed, stream);
  if (stream.Index(3) != 0) return stroke;
  const Eigen::Vector3d shift(stream.Uniform(-0.15, 0.15), stream.Uniform(-0.15, 0.15),
                              stream.Uniform(-0.03, 0));
  for (Eigen::Vector3d& point : stroke.control_points_m) point += shift;
  return stroke;
}

double Sum(const HeightMap& map) {
  return std::accumulate(map.height_m.begin(), map.height_m.end(), 0.0);
}

double Drift(const HeightMap& before, const HeightMap& after) {
  return std::abs(Sum(after) / Sum(before) - 1);
}

StressTally RunRollout(const SandModel& model, const StressConfig& config, int64_t rollout) {
  RandomStream stream(config.seed, StreamId("stress rollouts"), static_cast<uint64_t>(rollout));
  const std::string_view kind = kBeds[static_cast<size_t>(rollout) % kBeds.size()];
  SandState state(MakeBed(kind, CellSize(model), config.repose_deg, stream));
  const HeightMap start = state.map();
  const double repose = std::tan(RadiansOf(config.repose_deg));
  StressTally tally{.bed = std::string(kind), .rollouts = 1};
  const auto began = std::chrono::steady_clock::now();
  for (int k = 0; k < config.strokes_per_rollout; ++k) {
    const Stroke stroke = DrawHardStroke(state.map(), stream);
    const HeightMap before = state.map();
    const Outcome outcome = model.Apply(std::span(&state, 1), std::span(&stroke, 1)).front();
    const HeightMap& after = state.map();
    ++tally.strokes;
    tally.limited += outcome.limited();
    if (!std::ranges::all_of(after.height_m, [](float h) { return std::isfinite(h); })) {
      ++tally.not_finite;
      break;  // no model takes such a bed
    }
    const auto [lowest, highest] = std::ranges::minmax(after.height_m);
    tally.below_floor += lowest < 0;
    tally.too_high += highest > HighestPossible(std::ranges::max(before.height_m),
                                                outcome.moved_volume_m3, config.repose_deg);
    tally.stroke_drift_rel = std::max(tally.stroke_drift_rel, Drift(before, after));
    tally.slope_last = SteepestFace(after) / repose;
    if (k == 0) tally.slope_first = tally.slope_last;
    tally.steepest = std::max(tally.steepest, tally.slope_last);
  }
  tally.rollout_drift_rel = Drift(start, state.map());
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - began;
  tally.ms_per_stroke = took.count() / static_cast<double>(tally.strokes);
  return tally;
}

// Means are kept as sums until all rollouts are in.
void Include(const StressTally& rollout, StressTally& all) {
  all.rollouts += rollout.rollouts;
  all.strokes += rollout.strokes;
  all.limited += rollout.limited;
  all.not_finite += rollout.not_finite;
  all.below_floor += rollout.below_floor;
  all.too_high += rollout.too_high;
  all.stroke_drift_rel = std::max(all.stroke_drift_rel, rollout.stroke_drift_rel);
  all.rollout_drift_rel = std::max(all.rollout_drift_rel, rollout.rollout_drift_rel);
  all.steepest = std::max(all.steepest, rollout.steepest);
  all.slope_first += rollout.slope_first;
  all.slope_last += rollout.slope_last;
  all.ms_per_stroke += rollout.ms_per_stroke;
}

}  // namespace

nlohmann::json StressTally::ToJson() const {
  return {{"bed", bed},
          {"rollouts", rollouts},
          {"strokes", strokes},
          {"limited", limited},
          {"not_finite", not_finite},
          {"below_floor", below_floor},
          {"too_high", too_high},
          {"stroke_drift_rel", stroke_drift_rel},
          {"rollout_drift_rel", rollout_drift_rel},
          {"steepest_over_repose", steepest},
          {"slope_first_over_repose", slope_first},
          {"slope_last_over_repose", slope_last},
          {"ms_per_stroke", ms_per_stroke},
          {"sound", sound()}};
}

std::span<const std::string_view> StressBeds() { return kBeds; }

double HighestPossible(double highest_before_m, double moved_volume_m3, double repose_deg) {
  const double slope = std::tan(RadiansOf(repose_deg));
  // A quarter of a cone of height h holds pi h^3 / (12 slope^2).
  return highest_before_m + std::cbrt(12 * moved_volume_m3 * slope * slope / std::numbers::pi);
}

std::vector<StressTally> RunStressRollouts(const SandModel& model, const StressConfig& config,
                                           const std::function<void(int64_t)>& done) {
  SAND_CHECK(config.strokes > 0 && config.strokes_per_rollout > 0, config.strokes,
             config.strokes_per_rollout);
  const int64_t rollouts =
      (config.strokes + config.strokes_per_rollout - 1) / config.strokes_per_rollout;
  std::vector<StressTally> tallies;
  for (const std::string_view bed : kBeds) tallies.push_back({.bed = std::string(bed)});
  int64_t strokes = 0;
  for (int64_t first = 0; first < rollouts; first += config.threads) {
    ThrowIfStopRequested();
    std::vector<StressTally> round(
        static_cast<size_t>(std::min<int64_t>(config.threads, rollouts - first)));
    ParallelFor(static_cast<int>(round.size()), config.threads, [&](int i) {
      round[static_cast<size_t>(i)] = RunRollout(model, config, first + i);
    });
    for (size_t i = 0; i < round.size(); ++i) {
      Include(round[i], tallies[(static_cast<size_t>(first) + i) % kBeds.size()]);
      strokes += round[i].strokes;
    }
    done(strokes);
  }
  std::erase_if(tallies, [](const StressTally& tally) { return tally.rollouts == 0; });
  for (StressTally& tally : tallies) {
    const auto count = static_cast<double>(tally.rollouts);
    tally.slope_first /= count;
    tally.slope_last /= count;
    tally.ms_per_stroke /= count;
  }
  return tallies;
}

BoxDrift RunBoxDrift(const SandModel& model, const SandModel& truth, int strokes, uint64_t seed) {
  RandomStream stream(seed, StreamId("box drift"));
  const double cell_m = CellSize(model);
  const HeightMap start =
      GenerateTerrain({}, WholeCells(kBoxDepth_m, cell_m, "the box"),
                      WholeCells(kBoxWidth_m, cell_m, "the box"), cell_m, stream);
  SandState predicted(start), real(start);
  BoxDrift drift;
  CellRect window;
  for (int step = 1; step <= strokes; ++step) {
    ThrowIfStopRequested();
    const ToolPath path = SamplePath(DrawStroke({}, real.map(), stream), cell_m / 2);
    const auto began = std::chrono::steady_clock::now();
    model.Apply(std::span(&predicted, 1), std::span(&path, 1));
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - began;
    drift.ms_per_stroke += took.count() / strokes;
    truth.Apply(std::span(&real, 1), std::span(&path, 1));
    window = Union(window, ScoreWindow(start, real.map(), predicted.map(), path));
    drift.difference.Add(step, real.map(), predicted.map(), window);
  }
  drift.volume_drift_rel = Drift(start, predicted.map());
  return drift;
}

}  // namespace sandwright
