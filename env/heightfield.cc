#include "env/heightfield.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "data/base/parallel.h"
#include "env/avalanche.h"
#include "env/blade_cut.h"
#include "env/blade_path.h"

namespace sandwright {
namespace {

double TanDegrees(double angle_deg) { return std::tan(angle_deg * std::numbers::pi / 180); }

// Thousands of steps in float lose or make some millionths of the volume: gives them back, spread over
// the cells that moved and lie clear of the floor.
void GiveBackRounding(const HeightMap& before, const CellRect& rect, HeightMap& map) {
  constexpr float kClear_m = 1e-3f;
  double made_m = 0;  // heights summed over cells
  std::vector<size_t> moved;
  for (int row = rect.row0; row < rect.row1; ++row) {
    for (int column = rect.column0; column < rect.column1; ++column) {
      const size_t cell = map.Index(row, column);
      const double change_m = static_cast<double>(map.height_m[cell]) - before.height_m[cell];
      made_m += change_m;
      if (change_m != 0 && map.height_m[cell] > kClear_m) moved.push_back(cell);
    }
  }
  const double share_m = moved.empty() ? 0 : made_m / static_cast<double>(moved.size());
  for (const size_t cell : moved)
    map.height_m[cell] = static_cast<float>(map.height_m[cell] - share_m);
}

}  // namespace

Heightfield::Heightfield(HeightfieldConfig config) : config_(config) {
  const FieldList fields = FieldsOf(config);
  LoadJson(fields, ToJson(fields), "heightfield");  // checks the ranges
  if (config.loose_deg > config.repose_deg)
    throw Error(fmt::format("heightfield: loose_deg = {:g}; allowed: 5..{:g}, at most repose_deg",
                            config.loose_deg, config.repose_deg));
}

std::vector<Outcome> Heightfield::ApplyChecked(std::span<SandState> states,
                                               std::span<const ToolPath> paths) const {
  std::vector<Outcome> outcomes(states.size());
  ParallelFor(static_cast<int>(states.size()), static_cast<int>(config_.threads), [&](int i) {
    const auto row = static_cast<size_t>(i);
    outcomes[row] = ApplyOne(states[row], paths[row]);
  });
  return outcomes;
}

Outcome Heightfield::ApplyOne(SandState& state, const ToolPath& path) const {
  HeightMap map = state.map();
  const double cell = map.cell_size_m;
  const auto [poses, left_box, below_floor] =
      LimitPath(EqualSteps(path, config_.substep_cells * cell, config_.blade), config_.blade, map);
  Outcome outcome{.left_box = left_box, .below_floor = below_floor, .changed = {}};

  const bool floor_known = map.datum == Datum::kFloor;
  const double floor_m = floor_known ? 0 : -std::numeric_limits<double>::infinity();
  BladeCut blade(map, config_.blade, config_.cut, floor_m);
  const double loose_tan = TanDegrees(config_.loose_deg);
  Avalanche avalanche(state.map(), map, TanDegrees(config_.repose_deg) / loose_tan);
  avalanche.Disturb(blade.Plunge(poses.front()));
  for (size_t k = 1; k < poses.size(); ++k) {
    avalanche.Disturb(blade.Advance(poses[k - 1], poses[k]));
    const double diffusion_m2 =
        config_.relaxation_m * Travel(poses[k - 1], poses[k], config_.blade);
    avalanche.Flow(loose_tan, diffusion_m2 / (cell * cell), blade.ClosedFaces(poses[k]));
  }
  avalanche.Settle(loose_tan);
  outcome.changed = avalanche.touched();
  if (outcome.changed.empty()) return outcome;

  GiveBackRounding(state.map(), outcome.changed, map);
  outcome.moved_volume_m3 = MovedVolume(state.map(), map, outcome.changed);
  SAND_CHECK(std::isfinite(outcome.moved_volume_m3));
  state.Replace(std::move(map));
  return outcome;
}

}  // namespace sandwright
