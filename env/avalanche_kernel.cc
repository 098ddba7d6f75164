#include "env/avalanche_kernel.h"

#include <algorithm>
#include <cmath>

// One build for every x86-64, the wide version taken where the machine has it; no fused
// multiply-add in either, so both give the same bytes.
#if defined(__x86_64__) && defined(__linux__) && !defined(__SANITIZE_ADDRESS__)
#define SAND_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define SAND_WIDE
#endif
#define SAND_INLINE inline __attribute__((always_inline))

namespace sandwright {
namespace {

// Height differences at a face: along it (what drives the flux) and across (mean of the four
// one-sided differences beside it; a closed face counts as flat, as a wall does).
struct Rise {
  float along, across;
  float squared() const { return along * along + across * across; }
};

SAND_INLINE Rise RiseX(const float* h, int stride, int i) {
  return {h[i + 1] - h[i],
          0.25f * ((h[i + stride] - h[i - stride]) + (h[i + stride + 1] - h[i - stride + 1]))};
}

SAND_INLINE Rise RiseY(const float* h, int stride, int i) {
  return {h[i + stride] - h[i],
          0.25f * ((h[i + 1] - h[i - 1]) + (h[i + stride + 1] - h[i + stride - 1]))};
}

SAND_INLINE Rise MaskedRiseX(const float* h, const float* ox, const float* oy, int stride, int i) {
  const float left = oy[i] * (h[i + stride] - h[i]) + oy[i - stride] * (h[i] - h[i - stride]);
  const float right = oy[i + 1] * (h[i + stride + 1] - h[i + 1]) +
                      oy[i - stride + 1] * (h[i + 1] - h[i - stride + 1]);
  return {ox[i] * (h[i + 1] - h[i]), 0.25f * (left + right)};
}

SAND_INLINE Rise MaskedRiseY(const float* h, const float* ox, const float* oy, int stride, int i) {
  const float low = ox[i] * (h[i + 1] - h[i]) + ox[i - 1] * (h[i] - h[i - 1]);
  const float high = ox[i + stride] * (h[i + stride + 1] - h[i + stride]) +
                     ox[i + stride - 1] * (h[i + stride] - h[i + stride - 1]);
  return {oy[i] * (h[i + stride] - h[i]), 0.25f * (low + high)};
}

// Flux towards the lower index, per unit of diffusion: zero up to the critical slope.
SAND_INLINE float Flux(Rise r, float rise_m) {
  constexpr float kNotZero = 1e-30f;  // [m^2] a flat face divides by this, far below any slope
  return r.along * std::max(0.0f, 1.0f - rise_m / std::sqrt(r.squared() + kNotZero));
}

// Squared slope as a share of what the face resists. A face that is all but level along its own
// direction counts as level: steep firm sand beside it cannot move, so it would count for ever.
SAND_INLINE float Felt(Rise r, float resist, float rise_m) {
  constexpr float kLevel = 0.05f;
  const float squared = r.squared() / (resist * resist);
  return std::abs(r.along) > kLevel * rise_m ? squared : 0.0f;
}

// What untouched sand holds beyond the critical slope, or sand at repose would creep wherever its
// neighbour does.
constexpr float kFirmer = 1.005f;
// A face that nothing passes: far beyond any slope, and its square is finite.
constexpr float kShut = 1e12f;

}  // namespace

SAND_WIDE void AdvanceWindow(const AvalancheWindow& w, const CellSpan* spans, const float* y1,
                             const float* y2, float momentum, float step, float* out) {
  const int stride = w.stride;
  const float rise_m = w.rise_m;
  float* __restrict flux_x = w.flux;             // flux_x[i]: between columns i - 1 and i
  float* __restrict flux_low = w.flux + stride;  // between the row before and this one
  float* __restrict flux_high = w.flux + 2 * stride;
  std::fill(flux_low, flux_low + stride, 0.0f);
  for (int row = 0; row < w.rows; ++row) {
    const CellSpan span = spans[row];
    const CellSpan next = row + 1 < w.rows ? spans[row + 1] : CellSpan{0, 0};
    if (span.empty() && next.empty()) continue;
    const int line = (row + 1) * stride + 1;
    const bool masked = row >= w.mask_row0 && row < w.mask_row1;
    {
      const int first = span.empty()   ? next.first
                        : next.empty() ? span.first
                                       : std::min(span.first, next.first);
      const int faces = WholeLanes(std::max(span.last, next.last) - first), at = line + first;
      const float *h = y1 + at, *ox = w.open_x + at, *oy = w.open_y + at, *ry = w.resist_y + at;
      float* __restrict flux = flux_high + first;
      if (masked) {
        for (int i = 0; i < faces; ++i)
          flux[i] = Flux(MaskedRiseY(h, ox, oy, stride, i), rise_m * ry[i]);
      } else {
        for (int i = 0; i < faces; ++i) flux[i] = Flux(RiseY(h, stride, i), rise_m * ry[i]);
      }
    }
    if (!span.empty()) {
      const int at = line + span.first, count = span.last - span.first, faces = WholeLanes(count);
      const float *h = y1 + at, *ox = w.open_x + at, *oy = w.open_y + at, *rx = w.resist_x + at;
      const float* earlier = y2 + at;
      float* __restrict moved = out + at;
      float* __restrict flux = flux_x + span.first;
      if (masked) {
        for (int i = 0; i < faces; ++i)
          flux[i + 1] = Flux(MaskedRiseX(h, ox, oy, stride, i), rise_m * rx[i]);
      } else {
        for (int i = 0; i < faces; ++i) flux[i + 1] = Flux(RiseX(h, stride, i), rise_m * rx[i]);
      }
      flux[0] = flux[count] = 0;
      const float *low = flux_low + span.first, *high = flux_high + span.first;
      for (int i = 0; i < faces; ++i) {
        const float inflow = (flux[i + 1] - flux[i]) + (high[i] - low[i]);
        const float height = (h[i] + momentum * (h[i] - earlier[i])) + step * inflow;
        moved[i] = i < count ? height : moved[i];
      }
    }
    std::swap(flux_low, flux_high);
  }
}

SAND_WIDE float FeltSlopes(const AvalancheWindow& w, const float* heights, float* felt) {
  const int stride = w.stride, columns = w.columns, faces = WholeLanes(columns);
  const float rise_m = w.rise_m;
  float* __restrict square_x = w.flux;  // square_x[i]: between columns i - 1 and i
  float* __restrict square_low = w.flux + stride;
  float* __restrict square_high = w.flux + 2 * stride;
  std::fill(square_low, square_low + columns, 0.0f);
  float steepest = 0;
  for (int row = 0; row < w.rows; ++row) {
    const int first = (row + 1) * stride + 1;
    const float* h = heights + first;
    const float *ox = w.open_x + first, *oy = w.open_y + first;
    const float *rx = w.resist_x + first, *ry = w.resist_y + first;
    float* __restrict here = felt + first;
    const bool masked = row >= w.mask_row0 && row < w.mask_row1;
    if (masked) {
      for (int i = 0; i < faces; ++i)
        square_x[i + 1] = Felt(MaskedRiseX(h, ox, oy, stride, i), rx[i], rise_m);
    } else {
      for (int i = 0; i < faces; ++i) square_x[i + 1] = Felt(RiseX(h, stride, i), rx[i], rise_m);
    }
    square_x[0] = square_x[columns] = 0;
    if (row + 1 == w.rows) {
      std::fill(square_high, square_high + columns, 0.0f);
    } else if (masked) {
      for (int i = 0; i < faces; ++i)
        square_high[i] = Felt(MaskedRiseY(h, ox, oy, stride, i), ry[i], rise_m);
    } else {
      for (int i = 0; i < faces; ++i) square_high[i] = Felt(RiseY(h, stride, i), ry[i], rise_m);
    }
    float largest = 0;
    for (int i = 0; i < faces; ++i) {
      const float most =
          std::max(std::max(square_x[i], square_x[i + 1]), std::max(square_low[i], square_high[i]));
      here[i] = i < columns ? most : 0.0f;
      largest = std::max(largest, here[i]);
    }
    steepest = std::max(steepest, largest);
    std::swap(square_low, square_high);
  }
  return steepest;
}

SAND_WIDE void FindMoving(const AvalancheWindow& w, const float* felt, float limit, uint8_t* near,
                          uint8_t* moving, CellSpan* spans) {
  static_assert(kMargin == 3);
  const int columns = w.columns, bytes = WholeMarks(columns), stride = MarkStride(columns);
  // near[i], moving[i]: cell i - kMargin of a row.
  uint8_t* __restrict wide = moving;  // scratch until the rows are joined
  std::fill(wide, wide + stride, uint8_t{0});
  for (int row = 0; row < w.rows; ++row) {
    const float* line = felt + (row + 1) * w.stride + 1;
    for (int i = 0; i < bytes; ++i) wide[i + kMargin] = line[i] > limit;
    uint8_t* __restrict along = near + row * stride;
    for (int i = 0; i < bytes; ++i)
      along[i] = wide[i] | wide[i + 1] | wide[i + 2] | wide[i + 3] | wide[i + 4] | wide[i + 5] |
                 wide[i + 6];
  }
  for (int row = 0; row < w.rows; ++row) {
    uint8_t* __restrict line = moving + row * stride;
    std::fill(line, line + stride, uint8_t{0});
    const int row1 = std::min(row + kMargin, w.rows - 1);
    for (int other = std::max(row - kMargin, 0); other <= row1; ++other) {
      const uint8_t* __restrict along = near + other * stride;
      for (int i = 0; i < bytes; ++i) line[i] |= along[i];
    }
    for (int i = columns; i < bytes; ++i) line[i] = 0;
    CellSpan& span = spans[row] = {0, columns};
    while (span.first < columns && line[span.first] == 0) ++span.first;
    while (span.last > span.first && line[span.last - 1] == 0) --span.last;
  }
  std::fill(moving + w.rows * stride, moving + (w.rows + 1) * stride, uint8_t{0});
  for (int row = 0; row < w.rows; ++row) {
    const int faces = WholeLanes(columns);
    const uint8_t* m = moving + row * stride;
    float* __restrict rx = w.resist_x + (row + 1) * w.stride + 1;
    float* __restrict ry = w.resist_y + (row + 1) * w.stride + 1;
    for (int i = 0; i < faces; ++i) {
      rx[i] = m[i] & m[i + 1] ? rx[i] : kShut;
      ry[i] = m[i] & m[i + stride] ? ry[i] : kShut;
    }
  }
}

SAND_WIDE void RowSlopes(const float* below, const float* row, const float* above, int columns,
                         CellSpan cells, float* slope_x, float* slope_y) {
  const auto slope = [&](int i, int left, int right) {
    const float x = row[right] - row[i],
                x_across = 0.25f * ((above[i] - below[i]) + (above[right] - below[right]));
    const float y = above[i] - row[i],
                y_across = 0.25f * ((row[right] - row[left]) + (above[right] - above[left]));
    slope_x[i] = std::sqrt(x * x + x_across * x_across);
    slope_y[i] = std::sqrt(y * y + y_across * y_across);
  };
  const int first = std::max(cells.first, 1), last = std::min(cells.last, columns - 1);
  if (cells.first == 0) slope(0, 0, std::min(1, columns - 1));
  for (int i = first; i < last; ++i) slope(i, i - 1, i + 1);
  if (cells.last == columns) slope(columns - 1, std::max(columns - 2, 0), columns - 1);
}

SAND_WIDE void RowResistance(const float* slope_x, const float* slope_y, const uint8_t* loose,
                             const uint8_t* loose_above, int count, float firmness, float rise_m,
                             float* resist_x, float* resist_y) {
  const float per_rise = 1 / rise_m, least = kFirmer * firmness;
  for (int i = 0; i < WholeLanes(count); ++i) {
    const float firm_x = std::max(least, slope_x[i] * per_rise);
    const float firm_y = std::max(least, slope_y[i] * per_rise);
    resist_x[i] = (loose[i] | loose[i + 1]) ? 1.0f : firm_x;
    resist_y[i] = (loose[i] | loose_above[i]) ? 1.0f : firm_y;
  }
}

SAND_WIDE float LowestHeight(const float* heights, int count) {
  float lowest = heights[0];
  for (int i = 1; i < count; ++i) lowest = std::min(lowest, heights[i]);
  return lowest;
}

}  // namespace sandwright
