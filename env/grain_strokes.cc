#include "env/grain_strokes.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "data/base/error.h"
#include "data/base/random.h"
#include "env/dem.h"
#include "env/dem_bed.h"
#include "env/earth_moving.h"
#include "env/grains.h"
#include "env/score.h"

namespace sandwright {
namespace {

constexpr uint64_t kNudge = StreamId("grain checks nudge");
constexpr double kRepose_deg = 33;
constexpr double kCell_m = 0.002;       // of the maps
constexpr double kErrorCell_m = 0.004;  // of differences between two of them
constexpr double kGravity_mps2 = 9.81;

// A stroke's start and end on the cells of the maps.
struct StrokeRun {
  SandState before, after;
  Outcome outcome;
  DemReport report;
};

StrokeRun RunStroke(const DemConfig& config, const SandState& bed, const ToolPath& path) {
  StrokeRun run{bed, bed, {}, {}};
  run.outcome = Dem(config).ApplyStroke(run.after, path, run.report);
  return run;
}

double Difference_mm(const StrokeRun& a, const StrokeRun& b, const ToolPath& path) {
  const auto coarse = [](const SandState& state) { return Resample(state.map(), kErrorCell_m); };
  NoiseFloor difference;
  difference.Add(coarse(a.before), coarse(a.after), coarse(b.before), coarse(b.after), path);
  return difference.rmse_mm();
}

SandState Nudged(const SandState& bed, uint64_t seed) {
  RandomStream stream(seed, kNudge);
  GrainBed grains = *bed.grains();
  for (Grain& g : grains.grains) g.x_m += stream.Uniform(-1e-9, 1e-9);
  return SandState(bed.map(), std::make_shared<const GrainBed>(std::move(grains)));
}

// Force that drives the blade along x, a mean over its travel [from, to).
double MeanDraft_n(const StrokeRun& run, const DemConfig& config, double plunge_m, double from_m,
                   double to_m) {
  double sum_n = 0, n = 0;
  for (const BladeLoad& load : run.report.blade_loads) {
    const double travel_m = (load.time_s - plunge_m / config.plunge_mps) * config.speed_mps;
    if (travel_m < from_m || travel_m >= to_m) continue;
    sum_n -= load.force_n.x(), ++n;
  }
  if (n == 0) throw Error("no sample of the blade's load in that part of its travel");
  return sum_n / n;
}

GrainCheck DraftCheck(const std::string& when, double measured_n, EarthMoving sand) {
  constexpr double kFactor = 2;
  const double wedge_n = Draft_n(sand);
  EarthMoving plane = sand;
  plane.width_m = 1e3;
  plane.surcharge_n = 0;
  const double plane_n = Draft_n(plane) * sand.width_m / plane.width_m;
  return {"draft " + when,
          "N",
          measured_n,
          wedge_n / kFactor,
          wedge_n * kFactor,
          fmt::format("McKyes-Ali wedge {:.2f} N (plane, bare {:.2f} N), factor {}", wedge_n,
                      plane_n, kFactor)};
}

// The blade's load at the start, where no heap bears on the wedge yet, and at the end.
std::vector<GrainCheck> DraftChecks(const DemConfig& config, const LevelStroke& stroke,
                                    const StrokeRun& run, double end_x_m, double edge_m) {
  const HeightMap &before = run.before.map(), &after = run.after.map();
  double weight_n = 0, volume_m3 = 0, heap_m3 = 0, top_m = 0;
  for (const Grain& g : run.before.grains()->grains) {
    weight_n += config.material.density_kgpm3 * 4 / 3 * std::numbers::pi * std::pow(g.radius_m, 3) *
                kGravity_mps2;
    top_m = std::max(top_m, g.z_m + g.radius_m);
  }
  for (int row = 0; row < before.rows; ++row) {
    for (int column = 0; column < before.columns; ++column) {
      volume_m3 += before.At(row, column) * kCell_m * kCell_m;
      if ((column + 0.5) * kCell_m > end_x_m)
        heap_m3 +=
            std::max(0.0f, after.At(row, column) - before.At(row, column)) * kCell_m * kCell_m;
    }
  }
  const double plunge_m = top_m - edge_m;
  EarthMoving sand{.width_m = config.blade.width_m,
                   .depth_m = volume_m3 / before.width_m() / before.depth_m() - edge_m,
                   .unit_weight_npm3 = weight_n / volume_m3,
                   .repose_deg = kRepose_deg,
                   .blade_friction = config.blade_friction};
  std::vector<GrainCheck> checks = {
      DraftCheck("after 10-30 mm", MeanDraft_n(run, config, plunge_m, 0.01, 0.03), sand)};
  sand.surcharge_n = heap_m3 * sand.unit_weight_npm3;
  checks.push_back(DraftCheck(
      "over the last 20 mm, with its heap",
      MeanDraft_n(run, config, plunge_m, stroke.length_m - 0.02, stroke.length_m), sand));
  return checks;
}

}  // namespace

std::vector<GrainCheck> StrokeChecks(const DemConfig& config, const LevelStroke& stroke,
                                     uint64_t seed, const std::function<bool()>& stop) {
  const HeightMap level(static_cast<int>(std::lround(stroke.bed_width_m / kCell_m)),
                        static_cast<int>(std::lround(stroke.bed_length_m / kCell_m)), kCell_m,
                        static_cast<float>(stroke.bed_height_m));
  const double edge_m = stroke.bed_height_m - stroke.depth_m, y_m = stroke.bed_width_m / 2;
  const double start_x_m = (stroke.bed_length_m - stroke.length_m) / 2;
  const double end_x_m = start_x_m + stroke.length_m;
  const ToolPath path = {{start_x_m, y_m, edge_m, 0}, {end_x_m, y_m, edge_m, 0}};
  DemConfig fine = config, stiff = config;
  fine.material.time_step_share /= 2;
  stiff.material.stiffness_pa *= 4;  // halves the time step too

  const auto bed = [&](uint64_t packing) {
    auto grains = std::make_shared<const GrainBed>(CarvedBed(config, level, packing, stop));
    HeightMap surface = SurfaceOf(*grains, level.rows, level.columns, config.blur_m);
    return SandState(std::move(surface), std::move(grains));
  };
  const SandState start = bed(seed);
  const StrokeRun once = RunStroke(config, start, path);
  const StrokeRun other = RunStroke(config, bed(seed + 1), path);
  const StrokeRun nudged = RunStroke(config, Nudged(start, seed), path);
  const StrokeRun finer = RunStroke(fine, start, path), stiffer = RunStroke(stiff, start, path);

  const double noise_mm = Difference_mm(once, other, path);
  const auto same = [&](const std::string& name, const StrokeRun& run) {
    return GrainCheck{name, "mm",     Difference_mm(once, run, path),
                      0,    noise_mm, "less than another packing"};
  };
  const auto moved = [&](const std::string& name, const StrokeRun& run) {
    return GrainCheck{name + ", moved volume / that of the stroke", "1",
                      run.outcome.moved_volume_m3 / once.outcome.moved_volume_m3};
  };
  std::vector<GrainCheck> checks = {
      {"stroke: another packing", "mm", noise_mm},
      same("stroke: grains displaced by a nanometre", nudged),
      same("stroke: half the time step", finer),
      same("stroke: four times the stiffness", stiffer),
      moved("stroke: another packing", other),
      moved("stroke: half the time step", finer),
      moved("stroke: four times the stiffness", stiffer),
      {"stroke: deepest overlap / diameter", "1", once.report.deepest_overlap},
      {"stroke: deepest overlap / diameter, four times the stiffness", "1",
       stiffer.report.deepest_overlap},
      {"stroke: speed at rest", "m/s", once.report.rest_speed_mps, 0, 1e-3, "sand comes to rest"},
      {"stroke: grains lost", "grains", static_cast<double>(once.report.grains_lost), 0, 0,
       "none may vanish"}};
  std::ranges::move(DraftChecks(config, stroke, once, end_x_m, edge_m), std::back_inserter(checks));
  return checks;
}

}  // namespace sandwright
