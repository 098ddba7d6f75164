#include "env/observation.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "data/task.h"
#include "robot_model/safety_gate.h"

namespace sandwright {
namespace {

// One observation cell along one axis: the map's cells it reads and with what weight. The weights
// add up to `inside`, the share of the cell that lies within the walls.
struct Reach {
  int first = 0;
  std::vector<float> weight;
  float inside = 0;
};

// Observation cells over [origin, origin + extent] of an axis with `cells` map cells.
std::vector<Reach> Reaches(double origin_m, double extent_m, int count, int cells,
                           double cell_size_m) {
  std::vector<Reach> reaches(static_cast<size_t>(count));
  const double size = extent_m / count / cell_size_m;  // in map cells
  for (int k = 0; k < count; ++k) {
    Reach& reach = reaches[static_cast<size_t>(k)];
    const double low = origin_m / cell_size_m + k * size;
    const double from = std::clamp<double>(low, 0, cells),
                 to = std::clamp<double>(low + size, 0, cells);
    reach.inside = static_cast<float>((to - from) / size);
    if (to - from < 1e-9) continue;
    if (size < 1) {  // finer than the map: bilinear at the middle of the part inside
      const double middle = std::clamp((from + to) / 2 - 0.5, 0.0, cells - 1.0);
      reach.first = std::min(static_cast<int>(middle), cells - 2);
      const auto share = static_cast<float>(middle - reach.first);
      reach.weight = {reach.inside * (1 - share), reach.inside * share};
      continue;
    }
    reach.first = static_cast<int>(from);
    const int last = std::min(static_cast<int>(std::ceil(to)), cells);
    for (int i = reach.first; i < last; ++i)
      reach.weight.push_back(static_cast<float>(
          std::max(0.0, std::min<double>(to, i + 1) - std::max<double>(from, i)) / size));
  }
  return reaches;
}

// Gaussian blur of a [rows, columns] channel; beyond the edge there is nothing (0).
void Blur(const float* in, float* out, int rows, int columns, double sd_rows, double sd_columns) {
  const auto kernel = [](double sd) {
    const int radius = static_cast<int>(std::ceil(2.5 * sd));
    std::vector<float> taps(static_cast<size_t>(2 * radius + 1));
    double sum = 0;
    for (int k = -radius; k <= radius; ++k) sum += std::exp(-k * k / (2 * sd * sd));
    for (int k = -radius; k <= radius; ++k)
      taps[static_cast<size_t>(k + radius)] =
          static_cast<float>(std::exp(-k * k / (2 * sd * sd)) / sum);
    return taps;
  };
  const auto along = [&](const float* from, float* to, int lines, int line_step, int count,
                         int step, const std::vector<float>& taps) {
    const int radius = static_cast<int>(taps.size()) / 2;
    for (int line = 0; line < lines; ++line) {
      for (int i = 0; i < count; ++i) {
        float sum = 0;
        const int low = std::max(-radius, -i), high = std::min(radius, count - 1 - i);
        for (int k = low; k <= high; ++k)
          sum += taps[static_cast<size_t>(k + radius)] * from[line * line_step + (i + k) * step];
        to[line * line_step + i * step] = sum;
      }
    }
  };
  std::vector<float> half(static_cast<size_t>(rows) * static_cast<size_t>(columns));
  along(in, half.data(), rows, columns, columns, 1, kernel(sd_columns));
  along(half.data(), out, columns, 1, rows, columns, kernel(sd_rows));
}

void EncodeReach(const TaskView& view, int rows, int columns, float* reach) {
  const Region& region = view.region;
  for (int row = 0; row < rows; ++row) {
    const double y = region.y_m + (row + 0.5) * region.depth_m / rows;
    for (int column = 0; column < columns; ++column, ++reach) {
      *reach = ReachAt(view, region.x_m + (column + 0.5) * region.width_m / columns, y);
    }
  }
}

}  // namespace

ObservationSpec SpecOf(const ObservationConfig& config) {
  ObservationSpec spec{.channels = {"height", "goal_difference", "goal_difference_coarse", "mask", "in_box"},
          .rows = static_cast<int>(config.rows),
          .columns = static_cast<int>(config.columns),
          .numbers = {"budget_left", "budget_used", "rejected", "goal_error"}};
  if (config.reach) spec.channels.push_back("reach");
  return spec;
}

float ReachAt(const TaskView& view, double x_m, double y_m) {
  if (view.gate) return view.gate->reach().At(x_m, y_m);
  const bool inside =
      x_m >= 0 && x_m < view.sensed.width_m() && y_m >= 0 && y_m < view.sensed.depth_m();
  return inside ? 1.0f : 0.0f;
}

void Encode(const TaskView& view, const ObservationConfig& config, float* map_chw, float* vec) {
  const HeightMap& sensed = view.sensed;
  SAND_CHECK(sensed.SameGrid(view.goal) && view.max_strokes > 0, sensed.rows, view.goal.rows);
  const int rows = static_cast<int>(config.rows), columns = static_cast<int>(config.columns);
  const Region& region = view.region;
  const auto ys = Reaches(region.y_m, region.depth_m, rows, sensed.rows, sensed.cell_size_m);
  const auto xs = Reaches(region.x_m, region.width_m, columns, sensed.columns, sensed.cell_size_m);
  const size_t cells = static_cast<size_t>(rows) * static_cast<size_t>(columns);
  float* height = map_chw;
  float* difference = map_chw + cells;
  float* coarse = map_chw + 2 * cells;
  float* mask = map_chw + 3 * cells;
  float* in_box = map_chw + 4 * cells;

  double height_sum = 0, inside_sum = 0;
  size_t i = 0;
  for (const Reach& y : ys) {
    for (const Reach& x : xs) {
      float h = 0, d = 0, m = 0;
      for (size_t b = 0; b < y.weight.size(); ++b) {
        const size_t row = sensed.Index(y.first + static_cast<int>(b), x.first);
        for (size_t a = 0; a < x.weight.size(); ++a) {
          const float weight = y.weight[b] * x.weight[a];
          const float here = sensed.height_m[row + a];
          h += weight * here;
          if (!view.goal.mask[row + a]) continue;
          m += weight;
          d += weight * (view.goal.height_m[row + a] - here);
        }
      }
      height[i] = h;
      difference[i] = d / static_cast<float>(kDifferenceScale_m);
      mask[i] = m;
      in_box[i] = y.inside * x.inside;
      height_sum += h;
      inside_sum += in_box[i];
      ++i;
    }
  }
  SAND_CHECK(inside_sum > 0, region.x_m, region.y_m);
  const auto mean = static_cast<float>(height_sum / inside_sum);
  for (i = 0; i < cells; ++i)
    height[i] = (height[i] - mean * in_box[i]) / static_cast<float>(kHeightScale_m);
  Blur(difference, coarse, rows, columns, config.blur_m * rows / region.depth_m,
       config.blur_m * columns / region.width_m);

  if (config.reach) EncodeReach(view, rows, columns, map_chw + 5 * cells);

  vec[0] = static_cast<float>((view.max_strokes - view.strokes_used) / kBudgetScale);
  vec[1] = static_cast<float>(view.strokes_used) / static_cast<float>(view.max_strokes);
  vec[2] = static_cast<float>(view.rejected_in_a_row) / 3;
  vec[3] = static_cast<float>(GoalError(sensed, view.goal) / kErrorScale_m);
}

}  // namespace sandwright
