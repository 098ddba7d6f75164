#include "env/dem.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "data/base/stop.h"
#include "env/blade_path.h"
#include "env/dem_bed.h"
#include "env/stroke_window.h"

namespace sandwright {
namespace {

constexpr double kStep_m = 0.005;   // straight pieces of a curve
constexpr double kClear_m = 0.002;  // above the sand before coming down and after going up
constexpr double kMostOverlap = 0.03;

// Distance in the plane from a point to the segment between two poses.
double DistanceToSegment(double x, double y, const BladePose& a, const BladePose& b) {
  const double dx = b.x_m - a.x_m, dy = b.y_m - a.y_m, length2 = dx * dx + dy * dy;
  const double along = length2 > 0 ? ((x - a.x_m) * dx + (y - a.y_m) * dy) / length2 : 0;
  const double share = std::clamp(along, 0.0, 1.0);
  return std::hypot(x - a.x_m - share * dx, y - a.y_m - share * dy);
}

double DistanceToPath(double x, double y, const ToolPath& path) {
  double nearest = std::hypot(x - path.front().x_m, y - path.front().y_m);
  for (size_t i = 1; i < path.size(); ++i)
    nearest = std::min(nearest, DistanceToSegment(x, y, path[i - 1], path[i]));
  return nearest;
}

// The grains that a stroke can move, held by a shell of those around them. `index` says which they are.
DemScene SceneAround(const GrainBed& bed, const ToolPath& path, const DemConfig& config,
                     std::vector<size_t>& index) {
  const double shell_m = 2 * config.material.grain_m * (1 + config.material.grain_spread);
  DemScene scene;
  const double extent_m[2] = {bed.width_m, bed.depth_m};
  for (int axis = 0; axis < 2; ++axis) {
    const auto at = [axis](const BladePose& p) { return axis == 0 ? p.x_m : p.y_m; };
    const auto [low, high] = std::ranges::minmax(path, {}, at);
    const double reach_m = config.reach_m + shell_m;
    scene.wall_low[axis] = at(low) - reach_m <= 0;
    scene.wall_high[axis] = at(high) + reach_m >= extent_m[axis];
    scene.low_m[axis] = std::max(0.0, at(low) - reach_m);
    scene.high_m[axis] = std::min(extent_m[axis], at(high) + reach_m);
  }
  for (size_t i = 0; i < bed.grains.size(); ++i) {
    const Grain& g = bed.grains[i];
    const double distance_m = DistanceToPath(g.x_m, g.y_m, path);
    if (distance_m > config.reach_m + shell_m) continue;
    index.push_back(i);
    scene.grains.push_back(g);
    scene.held.push_back(distance_m > config.reach_m);
  }
  return scene;
}

// Straight down at the first pose, along the path, straight up at the last.
std::vector<BladeMove> MovesAlong(const ToolPath& path, double top_m, const DemConfig& config) {
  const auto lifted = [top_m](BladePose pose) {
    pose.z_m = std::max(pose.z_m, top_m);
    return pose;
  };
  std::vector<BladeMove> moves;
  const auto add = [&](const BladePose& a, const BladePose& b, double way_m, double speed_mps) {
    if (way_m > 0) moves.push_back({a, b, way_m / speed_mps});
  };
  const BladePose above = lifted(path.front()), out = lifted(path.back());
  add(above, path.front(), above.z_m - path.front().z_m, config.plunge_mps);
  for (size_t i = 1; i < path.size(); ++i)
    add(path[i - 1], path[i],
        std::hypot(Travel(path[i - 1], path[i], config.blade), path[i].z_m - path[i - 1].z_m),
        config.speed_mps);
  add(path.back(), out, out.z_m - path.back().z_m, config.lift_mps);
  return moves;
}

}  // namespace

Dem::Dem(DemConfig config) : config_(std::move(config)) {
  DemConfig checked = config_;
  const FieldList fields = FieldsOf(checked);
  LoadJson(fields, ToJson(fields), "dem");
}

SandState Dem::Start(HeightMap terrain, uint64_t seed) const {
  CheckHeightMap(terrain, "terrain");
  auto bed = std::make_shared<const GrainBed>(CarvedBed(config_, terrain, seed, StopRequested));
  HeightMap surface = SurfaceOf(*bed, terrain.rows, terrain.columns, config_.blur_m);
  return SandState(std::move(surface), std::move(bed));
}

std::vector<Outcome> Dem::ApplyChecked(std::span<SandState> states,
                                       std::span<const ToolPath> paths) const {
  std::vector<SandState> after(states.begin(), states.end());  // no row changes where one fails
  std::vector<Outcome> outcomes;
  for (size_t i = 0; i < states.size(); ++i) {
    DemReport report;
    outcomes.push_back(ApplyStroke(after[i], paths[i], report));
  }
  std::ranges::move(after, states.begin());
  return outcomes;
}

Outcome Dem::ApplyStroke(SandState& state, const ToolPath& path, DemReport& report) const {
  if (!state.grains())
    throw Error("sand model 'dem' was given a terrain without grains; its states come from Start");
  const HeightMap& before = state.map();
  const auto [poses, left_box, below_floor] =
      LimitPath(EqualSteps(path, kStep_m, config_.blade), config_.blade, before);
  GrainBed bed = *state.grains();
  std::vector<size_t> index;
  DemScene scene = SceneAround(bed, poses, config_, index);
  Outcome outcome{.left_box = left_box, .below_floor = below_floor, .changed = {}};
  double top_m = 0;
  for (const Grain& g : scene.grains) top_m = std::max(top_m, g.z_m + g.radius_m);
  report = RunGrains(config_, MovesAlong(poses, top_m + kClear_m, config_), scene, StopRequested);
  if (report.grains_lost > 0)
    throw GrainsLost(fmt::format("{} of {} grains were lost in a stroke", report.grains_lost,
                                 report.grains_moving),
                     ErrorKind::kInternal);
  if (report.deepest_overlap > kMostOverlap)
    spdlog::warn("grains overlapped by {:.1f} % of their diameter; more than {:g} % is soft",
                 100 * report.deepest_overlap, 100 * kMostOverlap);

  for (size_t i = 0; i < index.size(); ++i) bed.grains[index[i]] = scene.grains[i];
  HeightMap after = SurfaceOf(bed, before.rows, before.columns, config_.blur_m);
  outcome.changed = ChangedBounds(before, after, 0);
  outcome.moved_volume_m3 = MovedVolume(before, after, outcome.changed);
  state.Replace(std::move(after), std::make_shared<const GrainBed>(std::move(bed)));
  return outcome;
}

}  // namespace sandwright
