#include "env/feasible_goal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "data/gridding.h"
#include "env/avalanche.h"

namespace sandwright {
namespace {

constexpr double kSlopeSlack = 1.02, kNarrow_m = 0.001;
constexpr double kRadian = std::numbers::pi / 180;

// The goal with its uncounted cells spanned smoothly, so that nothing at the mask's edge looks steep or narrow.
HeightMap Continued(const HeightMap& goal) {
  HeightMap whole = goal;
  whole.valid = goal.mask;
  if (std::ranges::count(goal.mask, 0) > 0) FillHoles(whole);
  whole.valid.clear();
  whole.mask.clear();
  return whole;
}

// Closes pits and cuts crests narrower than allowed; less than three cells wide is left as it is.
void Widen(HeightMap& map, const FeasibilityConfig& config) {
  cv::Mat image(map.rows, map.columns, CV_32F, map.height_m.data());
  const auto apply = [&](double width_m, int operation) {
    int cells = static_cast<int>(std::lround(width_m / map.cell_size_m));
    cells -= cells % 2 == 0;  // odd, so that nothing shifts
    if (cells < 3) return;
    cv::morphologyEx(image, image, operation, cv::getStructuringElement(cv::MORPH_ELLIPSE, {cells, cells}));
  };
  apply(config.narrowest_crest_m, cv::MORPH_OPEN);
  apply(config.narrowest_pit_m, cv::MORPH_CLOSE);
}

// Rise over run at the side of a cell towards its next column (or row): the full gradient, across the side from the
// two cells, along it from the cells beside them that count.
double SlopeAtSide(const HeightMap& goal, int row, int column, bool along_x) {
  const auto counts = [&](int r, int c) {
    return r >= 0 && c >= 0 && r < goal.rows && c < goal.columns && goal.mask[goal.Index(r, c)];
  };
  const int r1 = row + !along_x, c1 = column + along_x;
  if (!counts(row, column) || !counts(r1, c1)) return 0;
  const double across = goal.At(r1, c1) - goal.At(row, column);
  double along = 0;
  int sides = 0;
  for (const auto& [r, c] : {std::pair{row, column}, {r1, c1}}) {
    for (const int step : {-1, 1}) {
      const int rn = r + (along_x ? step : 0), cn = c + (along_x ? 0 : step);
      if (counts(rn, cn)) along += step * static_cast<double>(goal.At(rn, cn) - goal.At(r, c)), ++sides;
    }
  }
  return std::hypot(across, sides > 0 ? along / sides : 0) / goal.cell_size_m;
}

// Marks the cells at a side that is steeper than `limit`; the steepest of all sides [1].
double MarkSteep(const HeightMap& goal, double limit, std::vector<uint8_t>& faults) {
  double steepest = 0;
  for (int row = 0; row < goal.rows; ++row) {
    for (int column = 0; column < goal.columns; ++column) {
      for (const bool along_x : {true, false}) {
        const double slope = SlopeAtSide(goal, row, column, along_x);
        steepest = std::max(steepest, slope);
        if (slope <= kSlopeSlack * limit) continue;
        faults[goal.Index(row, column)] |= kTooSteep;
        faults[goal.Index(row + !along_x, column + along_x)] |= kTooSteep;
      }
    }
  }
  return steepest;
}

struct Faults {
  std::vector<uint8_t> cells;
  double steepest = 0, narrow_worst_m = 0;
};

Faults FindFaults(const HeightMap& goal, const FeasibilityConfig& config, const ReachMap* reach) {
  Faults found{.cells = std::vector<uint8_t>(goal.size(), 0)};
  HeightMap wide = Continued(goal);
  Widen(wide, config);
  for (int row = 0; row < goal.rows; ++row) {
    for (int column = 0; column < goal.columns; ++column) {
      const size_t i = goal.Index(row, column);
      if (!goal.mask[i]) continue;
      const double changed_m = std::abs(wide.height_m[i] - goal.height_m[i]);
      found.narrow_worst_m = std::max(found.narrow_worst_m, changed_m);
      const double x_m = (column + 0.5) * goal.cell_size_m, y_m = (row + 0.5) * goal.cell_size_m;
      if (changed_m > kNarrow_m) found.cells[i] |= kTooNarrow;
      if (goal.datum == Datum::kFloor && goal.height_m[i] < 0) found.cells[i] |= kBelowFloor;
      if (reach != nullptr && reach->At(x_m, y_m) == 0) found.cells[i] |= kOutOfReach;
    }
  }
  found.steepest = MarkSteep(goal, std::tan(config.repose_deg * kRadian), found.cells);
  return found;
}

// The smallest level shift with which max(floor, height + shift) has the terrain's volume over the mask, but for what
// the ground around it takes or gives. The volume grows with the shift without a jump, so halving finds it.
double LevelShift(const HeightMap& goal, const HeightMap& terrain, double free_spread_m) {
  const bool floor = terrain.datum == Datum::kFloor;
  const auto surplus = [&](double shift_m) {
    double sum_m = 0;
    for (size_t i = 0; i < goal.size(); ++i) {
      if (!goal.mask[i]) continue;
      const double h = goal.height_m[i] + shift_m;
      sum_m += (floor ? std::max(h, 0.0) : h) - terrain.height_m[i];
    }
    return sum_m;
  };
  const double free_m = free_spread_m * static_cast<double>(std::ranges::count(goal.mask, 0));
  const double target_m = std::clamp(surplus(0), -free_m, free_m);
  if (target_m == surplus(0)) return 0;
  double low_m = -1e-3, high_m = 1e-3;
  while (surplus(low_m) > target_m && low_m > -1e3) low_m *= 2;
  while (surplus(high_m) < target_m) high_m *= 2;
  for (int i = 0; i < 60; ++i) {
    const double middle_m = (low_m + high_m) / 2;
    (surplus(middle_m) < target_m ? low_m : high_m) = middle_m;
  }
  return (low_m + high_m) / 2;
}

}  // namespace

Feasibility JudgeGoal(const HeightMap& goal, const HeightMap& terrain, const FeasibilityConfig& config,
                      const ReachMap* reach) {
  SAND_CHECK(goal.SameGrid(terrain) && goal.mask.size() == goal.size(), goal.rows, terrain.rows);
  const auto counted = static_cast<size_t>(std::ranges::count(goal.mask, 1));
  SAND_CHECK(counted > 0);
  const Faults faults = FindFaults(goal, config, reach);
  Feasibility found;
  double missing_m = 0;
  for (size_t i = 0; i < goal.size(); ++i) {
    if (goal.mask[i]) missing_m += static_cast<double>(goal.height_m[i]) - terrain.height_m[i];
  }
  const auto share = [&](GoalFault fault) {
    const auto cells = std::ranges::count_if(faults.cells, [fault](uint8_t bits) { return (bits & fault) != 0; });
    return static_cast<double>(cells) / static_cast<double>(counted);
  };
  found.volume_missing_m3 = missing_m * goal.cell_size_m * goal.cell_size_m;
  found.steep_share = share(kTooSteep);
  found.steepest_deg = std::atan(faults.steepest) / kRadian;
  found.narrow_share = share(kTooNarrow);
  found.narrow_worst_m = faults.narrow_worst_m;
  found.below_floor_share = share(kBelowFloor);
  if (reach != nullptr) found.out_of_reach_share = share(kOutOfReach);
  return found;
}

std::vector<uint8_t> GoalFaults(const HeightMap& goal, const FeasibilityConfig& config, const ReachMap* reach) {
  return FindFaults(goal, config, reach).cells;
}

HeightMap NearestFeasible(const HeightMap& goal, const HeightMap& terrain, const FeasibilityConfig& config) {
  SAND_CHECK(goal.SameGrid(terrain) && goal.mask.size() == goal.size(), goal.rows, terrain.rows);
  HeightMap shaped = Continued(goal);
  shaped.datum = Datum::kRelative;  // it gets its level last
  Widen(shaped, config);
  RelaxToRepose(shaped, config.repose_deg);
  shaped.mask = goal.mask;
  const double shift_m = LevelShift(shaped, terrain, config.free_spread_m);
  HeightMap feasible = goal;
  for (size_t i = 0; i < goal.size(); ++i) {
    if (!goal.mask[i]) continue;
    const double h = shaped.height_m[i] + shift_m;
    feasible.height_m[i] = static_cast<float>(terrain.datum == Datum::kFloor ? std::max(h, 0.0) : h);
  }
  return feasible;
}

nlohmann::json ToJson(const Feasibility& feasibility) {
  nlohmann::json json = {{"volume_missing_cm3", 1e6 * feasibility.volume_missing_m3},
                         {"steep_share", feasibility.steep_share},
                         {"steepest_deg", feasibility.steepest_deg},
                         {"narrow_share", feasibility.narrow_share},
                         {"narrow_worst_mm", 1e3 * feasibility.narrow_worst_m},
                         {"below_floor_share", feasibility.below_floor_share}};
  if (feasibility.out_of_reach_share) json["out_of_reach_share"] = *feasibility.out_of_reach_share;
  return json;
}

}  // namespace sandwright
