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

}  // namespace

SAND_WIDE void AdvanceWindow(const AvalancheWindow& w) {
  const int stride = w.stride, columns = w.columns, faces = WholeLanes(columns);
  const float rise_m = w.rise_m, momentum = w.momentum, step = w.step;
  float* __restrict flux_x = w.flux;             // flux_x[i]: between columns i - 1 and i
  float* __restrict flux_low = w.flux + stride;  // between the row before and this one
  float* __restrict flux_high = w.flux + 2 * stride;
  std::fill(flux_low, flux_low + columns, 0.0f);
  flux_x[0] = 0;
  for (int row = 0; row < w.rows; ++row) {
    const int first = (row + 1) * stride + 1;
    const float* h = w.y1 + first;
    const float* earlier = w.y2 + first;
    const float *ox = w.open_x + first, *oy = w.open_y + first;
    const float *rx = w.resist_x + first, *ry = w.resist_y + first;
    float* __restrict out = w.out + first;
    const bool masked = row >= w.mask_row0 && row < w.mask_row1;
    if (masked) {
      for (int i = 0; i < faces; ++i)
        flux_x[i + 1] = Flux(MaskedRiseX(h, ox, oy, stride, i), rise_m * rx[i]);
    } else {
      for (int i = 0; i < faces; ++i) flux_x[i + 1] = Flux(RiseX(h, stride, i), rise_m * rx[i]);
    }
    flux_x[columns] = 0;
    if (row + 1 == w.rows) {
      std::fill(flux_high, flux_high + columns, 0.0f);
    } else if (masked) {
      for (int i = 0; i < faces; ++i)
        flux_high[i] = Flux(MaskedRiseY(h, ox, oy, stride, i), rise_m * ry[i]);
    } else {
      for (int i = 0; i < faces; ++i) flux_high[i] = Flux(RiseY(h, stride, i), rise_m * ry[i]);
    }
    for (int i = 0; i < columns; ++i) {
      const float inflow = (flux_x[i + 1] - flux_x[i]) + (flux_high[i] - flux_low[i]);
      out[i] = (h[i] + momentum * (h[i] - earlier[i])) + step * inflow;
    }
    std::swap(flux_low, flux_high);
  }
}

SAND_WIDE void SteepestFaces(const AvalancheWindow& w, float* of_row, float* of_column) {
  const int stride = w.stride, columns = w.columns, faces = WholeLanes(columns);
  const float rise_m = w.rise_m;
  float* __restrict square_x = w.flux;
  float* __restrict square_y = w.flux + stride;
  float* __restrict column_max = of_column;
  std::fill(of_row, of_row + w.rows, 0.0f);
  std::fill(of_column, of_column + columns, 0.0f);
  for (int row = 0; row < w.rows; ++row) {
    const int first = (row + 1) * stride + 1;
    const float* h = w.y1 + first;
    const float *ox = w.open_x + first, *oy = w.open_y + first;
    const float *rx = w.resist_x + first, *ry = w.resist_y + first;
    const bool masked = row >= w.mask_row0 && row < w.mask_row1;
    if (masked) {
      for (int i = 0; i < faces; ++i)
        square_x[i + 1] = Felt(MaskedRiseX(h, ox, oy, stride, i), rx[i], rise_m);
    } else {
      for (int i = 0; i < faces; ++i) square_x[i + 1] = Felt(RiseX(h, stride, i), rx[i], rise_m);
    }
    square_x[0] = square_x[columns] = 0;  // square_x[i]: between columns i - 1 and i
    if (row + 1 == w.rows) {
      std::fill(square_y, square_y + columns, 0.0f);
    } else if (masked) {
      for (int i = 0; i < faces; ++i)
        square_y[i] = Felt(MaskedRiseY(h, ox, oy, stride, i), ry[i], rise_m);
    } else {
      for (int i = 0; i < faces; ++i) square_y[i] = Felt(RiseY(h, stride, i), ry[i], rise_m);
    }
    float largest = 0, largest_y = 0;
    for (int i = 0; i < columns; ++i) {
      const float here = std::max(std::max(square_x[i], square_x[i + 1]), square_y[i]);
      column_max[i] = std::max(column_max[i], here);
      largest = std::max(largest, here);
      largest_y = std::max(largest_y, square_y[i]);
    }
    of_row[row] = std::max(of_row[row], largest);
    if (row + 1 < w.rows) of_row[row + 1] = largest_y;
  }
}

SAND_WIDE void FaceResistance(const float* firm, const float* loose, int rows, int columns,
                              int stride, float rise_m, float* resist_x, float* resist_y) {
  const int faces = WholeLanes(columns);
  const auto resist = [rise_m](Rise r, float either_loose) {
    const float firm_share = std::max(kFirmer, std::sqrt(r.squared()) / rise_m);
    return either_loose + (1 - either_loose) * firm_share;
  };
  for (int row = 0; row < rows; ++row) {
    const int first = (row + 1) * stride + 1;
    const float *h = firm + first, *l = loose + first;
    float* __restrict rx = resist_x + first, * __restrict ry = resist_y + first;
    for (int i = 0; i < faces; ++i) rx[i] = resist(RiseX(h, stride, i), std::max(l[i], l[i + 1]));
    for (int i = 0; i < faces; ++i)
      ry[i] = resist(RiseY(h, stride, i), std::max(l[i], l[i + stride]));
  }
}

SAND_WIDE float LowestHeight(const float* heights, int count) {
  float lowest = heights[0];
  for (int i = 1; i < count; ++i) lowest = std::min(lowest, heights[i]);
  return lowest;
}

}  // namespace sandwright
