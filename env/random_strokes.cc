#include "env/random_strokes.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>

#include "data/base/parallel.h"
#include "data/base/random.h"
#include "data/base/stop.h"
#include "data/excavation.h"
#include "env/terrain_generator.h"

namespace sandwright {
namespace {

constexpr int kPerBed = 50;
constexpr double kCells_m[] = {0.005, 0.01, 0.005, 0.02, 0.005, 0.01, 0.005, 0.0025};

double Volume(const HeightMap& map) {
  return std::accumulate(map.height_m.begin(), map.height_m.end(), 0.0);
}

void Include(const RandomStrokeTally& bed, RandomStrokeTally& all) {
  all.strokes += bed.strokes;
  all.limited += bed.limited;
  all.not_finite += bed.not_finite;
  all.lowest_m = std::min(all.lowest_m, bed.lowest_m);
  all.steepest = std::max(all.steepest, bed.steepest);
  all.volume_drift_rel = std::max(all.volume_drift_rel, bed.volume_drift_rel);
}

RandomStrokeTally RunBed(const Heightfield& model, int64_t bed, int strokes, uint64_t seed) {
  RandomStream stream(seed, StreamId("random strokes"), static_cast<uint64_t>(bed));
  const double cell_m = kCells_m[bed % std::size(kCells_m)];
  const int cells = static_cast<int>(std::lround(0.4 / cell_m));
  const double repose = std::tan(model.config().repose_deg * std::numbers::pi / 180);
  SandState state(GenerateTerrain({.amplitude_m = 0.015, .repose_deg = model.config().repose_deg},
                                  cells, cells + 10, cell_m, stream));
  RandomStrokeTally tally;
  for (int k = 0; k < strokes; ++k) {
    Stroke stroke = DrawStroke({.floor_margin_m = 0, .deepest_m = 0.06}, state.map(), stream);
    if (k % 10 == 9) {
      const Eigen::Vector3d shift(0.2 * (stream.Uniform() - 0.5), 0.2 * (stream.Uniform() - 0.5),
                                  -0.02 * stream.Uniform());
      for (Eigen::Vector3d& point : stroke.control_points_m) point += shift;
    }
    const HeightMap before = state.map();
    const Outcome outcome = model.Apply(std::span(&state, 1), std::span(&stroke, 1)).front();
    const HeightMap& after = state.map();
    ++tally.strokes;
    tally.limited += outcome.limited();
    tally.not_finite +=
        !std::ranges::all_of(after.height_m, [](float h) { return std::isfinite(h); });
    tally.lowest_m = std::min<double>(tally.lowest_m, *std::ranges::min_element(after.height_m));
    tally.steepest = std::max(tally.steepest, SteepestFace(after) / repose);
    tally.volume_drift_rel =
        std::max(tally.volume_drift_rel, std::abs(Volume(after) / Volume(before) - 1));
  }
  return tally;
}

}  // namespace

nlohmann::json RandomStrokeTally::ToJson() const {
  return {{"strokes", strokes},
          {"limited", limited},
          {"not_finite", not_finite},
          {"lowest_m", lowest_m},
          {"steepest_over_repose", steepest},
          {"volume_drift_rel", volume_drift_rel},
          {"ms_per_stroke", ms_per_stroke},
          {"sound", sound()}};
}

RandomStrokeTally RunRandomStrokes(const HeightfieldConfig& config, int64_t strokes, uint64_t seed,
                                   int threads,
                                   const std::function<void(const RandomStrokeTally&)>& progress) {
  constexpr int64_t kRound = 16;  // beds
  HeightfieldConfig single = config;
  single.threads = 1;
  const Heightfield model(single);
  const int64_t beds = (strokes + kPerBed - 1) / kPerBed;
  RandomStrokeTally all;
  const auto start = std::chrono::steady_clock::now();
  for (int64_t first = 0; first < beds; first += kRound) {
    ThrowIfStopRequested();
    std::vector<RandomStrokeTally> round(static_cast<size_t>(std::min(kRound, beds - first)));
    ParallelFor(static_cast<int>(round.size()), threads, [&](int i) {
      const int64_t bed = first + i;
      round[static_cast<size_t>(i)] = RunBed(
          model, bed, static_cast<int>(std::min<int64_t>(kPerBed, strokes - bed * kPerBed)), seed);
    });
    for (const RandomStrokeTally& bed : round) Include(bed, all);
    const std::chrono::duration<double, std::milli> spent =
        std::chrono::steady_clock::now() - start;
    all.ms_per_stroke = spent.count() / static_cast<double>(all.strokes);
    progress(all);
  }
  return all;
}

double SteepestFace(const HeightMap& map) {
  const auto at = [&](int row, int column) {
    return static_cast<double>(
        map.At(std::clamp(row, 0, map.rows - 1), std::clamp(column, 0, map.columns - 1)));
  };
  double steepest2 = 0;
  for (int row = 0; row < map.rows; ++row) {
    for (int column = 0; column < map.columns; ++column) {
      const auto slope2 = [&](int dr, int dc) {
        const auto across = [&](int r, int c) { return at(r + dc, c + dr) - at(r - dc, c - dr); };
        const double along = at(row + dr, column + dc) - at(row, column);
        const double mean = (across(row, column) + across(row + dr, column + dc)) / 4;
        return along * along + mean * mean;
      };
      if (column + 1 < map.columns) steepest2 = std::max(steepest2, slope2(0, 1));
      if (row + 1 < map.rows) steepest2 = std::max(steepest2, slope2(1, 0));
    }
  }
  return std::sqrt(steepest2) / map.cell_size_m;
}

}  // namespace sandwright
