#include "env/avalanche.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "env/avalanche_kernel.h"

namespace sandwright {
namespace {

// Explicit steps are stable up to 1/4; each cell then gives at most four times that share of its
// height, so none goes below the floor.
constexpr double kPlainStep = 0.24;
// Longer Legendre sums distort fronts; what comes to rest stays distorted, so it gets shorter ones and,
// while a slope is this much steeper than critical, plain steps (tests/support/reference_avalanche.h).
constexpr int kFlowStages = 9, kSettleStages = 5;
constexpr double kPlainAbove = 1.14;
constexpr double Reach(int stages) { return kPlainStep * stages * (stages + 1) / 2; }
// Share by which a slope must pass the angle to count as still flowing: while the blade moves, and at rest.
constexpr double kFlowTolerance = 0.05, kRestTolerance = 1e-3;
// Above the rounding of slopes in float, so that a slope exactly at the angle does not creep.
constexpr double kRoundingSlack = 2e-5;
// Change of a firm cell, as a share of the critical rise, that makes it loose.
constexpr double kLoosening = 1e-2;
// Sand may run this many cells past the steep ones in one step.
constexpr int kMargin = 3;

float LowestIn(const std::vector<float>& heights) {
  return LowestHeight(heights.data(), static_cast<int>(heights.size()));
}

}  // namespace

Avalanche::Avalanche(HeightMap& map) : map_(map), loose_(map.size(), 0), firm_m_(map.height_m) {}

void Avalanche::Disturb(std::span<const size_t> cells) {
  const auto columns = static_cast<size_t>(map_.columns);
  for (const size_t cell : cells) {
    loose_[cell] = 1;
    const int row = static_cast<int>(cell / columns), column = static_cast<int>(cell % columns);
    active_ = Union(active_, {row, column, row + 1, column + 1});
  }
  touched_ = Union(touched_, active_);
}

void Avalanche::Load(const CellRect& active, std::span<const CellFace> closed, double rise_m) {
  window_ = {std::max(active.row0 - kMargin, 0), std::max(active.column0 - kMargin, 0),
             std::min(active.row1 + kMargin, map_.rows),
             std::min(active.column1 + kMargin, map_.columns)};
  stride_ = WholeLanes(window_.columns()) + 2;
  const size_t size = static_cast<size_t>(stride_) * static_cast<size_t>(window_.rows() + 2);
  for (std::vector<float>* y : {&start_, &window_firm_, &window_loose_, &resist_x_, &resist_y_})
    y->resize(size);
  for (int row = -1; row <= window_.rows(); ++row) {
    const int from = std::clamp(window_.row0 + row, 0, map_.rows - 1);
    const auto copy_row = [&](const std::vector<float>& whole, std::vector<float>& part) {
      const float* source = &whole[map_.Index(from, 0)];
      float* target = &part[static_cast<size_t>((row + 1) * stride_)];
      target[0] = source[std::max(window_.column0 - 1, 0)];
      std::copy(source + window_.column0, source + window_.column1, target + 1);
      target[window_.columns() + 1] = source[std::min(window_.column1, map_.columns - 1)];
    };
    copy_row(map_.height_m, start_);
    copy_row(firm_m_, window_firm_);
    copy_row(loose_, window_loose_);
  }
  out_ = y1_ = y2_ = start_;  // the ring outside the window stays as it is
  FaceResistance(window_firm_.data(), window_loose_.data(), window_.rows(), window_.columns(),
                 stride_, static_cast<float>(rise_m), resist_x_.data(), resist_y_.data());

  mask_row0_ = window_.rows();
  mask_row1_ = 0;
  open_x_.assign(size, 1.0f);
  open_y_.assign(size, 1.0f);
  for (const CellFace& face : closed) {
    const int row = face.row - window_.row0, column = face.column - window_.column0;
    if (row < 0 || column < 0 || row >= window_.rows() || column >= window_.columns()) continue;
    (face.along_x ? open_x_ : open_y_)[static_cast<size_t>((row + 1) * stride_ + column + 1)] = 0;
    mask_row0_ = std::min(mask_row0_, row - 1);
    mask_row1_ = std::max(mask_row1_, row + 3);
  }
}

void Avalanche::Store(double rise_m) {
  const auto moved = static_cast<float>(kLoosening * rise_m);
  for (int row = 0; row < window_.rows(); ++row) {
    const float* source = &start_[static_cast<size_t>((row + 1) * stride_ + 1)];
    const size_t first = map_.Index(window_.row0 + row, window_.column0);
    float *target = &map_.height_m[first], *loose = &loose_[first];
    const float* firm = &firm_m_[first];
    for (int i = 0; i < window_.columns(); ++i) {
      if (std::abs(source[i] - firm[i]) > moved) loose[i] = 1;
      target[i] = source[i];
    }
  }
  touched_ = Union(touched_, window_);
}

// At a wall the ring repeats the cells inside: no slope across it.
void Avalanche::MirrorWalls(std::vector<float>& y) const {
  const int rows = window_.rows(), columns = window_.columns();
  if (window_.column0 == 0 || window_.column1 == map_.columns) {
    for (int row = 1; row <= rows; ++row) {
      float* line = &y[static_cast<size_t>(row * stride_)];
      if (window_.column0 == 0) line[0] = line[1];
      if (window_.column1 == map_.columns) line[columns + 1] = line[columns];
    }
  }
  if (window_.row0 == 0) std::copy_n(&y[static_cast<size_t>(stride_)], stride_, y.data());
  if (window_.row1 == map_.rows)
    std::copy_n(&y[static_cast<size_t>(rows * stride_)], stride_,
                &y[static_cast<size_t>((rows + 1) * stride_)]);
}

void Avalanche::Stage(const std::vector<float>& y1, const std::vector<float>& y2, float momentum,
                      float step, double rise_m, std::vector<float>& out) {
  flux_.resize(3 * static_cast<size_t>(stride_));
  AdvanceWindow({y1.data(), y2.data(), out.data(), open_x_.data(), open_y_.data(), resist_x_.data(),
                 resist_y_.data(), flux_.data(), window_.rows(), window_.columns(), stride_,
                 mask_row0_, mask_row1_, momentum, step, static_cast<float>(rise_m)});
  MirrorWalls(out);
}

Avalanche::Steepness Avalanche::FindSteep(double rise_m) {
  const int rows = window_.rows(), columns = window_.columns();
  std::vector<float> of_row(static_cast<size_t>(rows)), of_column(static_cast<size_t>(columns));
  flux_.resize(3 * static_cast<size_t>(stride_));
  SteepestFaces({start_.data(), nullptr, nullptr, open_x_.data(), open_y_.data(), resist_x_.data(),
                 resist_y_.data(), flux_.data(), rows, columns, stride_, mask_row0_, mask_row1_, 0,
                 0, static_cast<float>(rise_m)},
                of_row.data(), of_column.data());
  const auto limit = static_cast<float>(rise_m * rise_m);
  const auto is_steep = [limit](float g2) { return g2 > limit; };
  Steepness found;
  found.steepest = *std::ranges::max_element(of_row);
  if (!is_steep(found.steepest)) return found;
  const auto bounds = [&](const std::vector<float>& values, int offset) {
    const auto first = std::ranges::find_if(values, is_steep);
    const auto last = std::find_if(values.rbegin(), values.rend(), is_steep);
    return std::pair(offset + static_cast<int>(first - values.begin()),
                     offset + static_cast<int>(values.rend() - last));
  };
  const auto [row0, row1] = bounds(of_row, window_.row0);
  const auto [column0, column1] = bounds(of_column, window_.column0);
  found.where = {row0, column0, row1, column1};
  return found;
}

void Avalanche::PlainSteps(double rise_m, double amount) {
  const int count = std::max(1, static_cast<int>(std::ceil(amount / kPlainStep - 1e-9)));
  for (int i = 0; i < count; ++i) {
    Stage(start_, start_, 0, static_cast<float>(amount / count), rise_m, out_);
    std::swap(start_, out_);
  }
}

// RKL1: Y1 = Y0 + w tau L(Y0), Yj = mu_j Y(j-1) + nu_j Y(j-2) + mu_j w tau L(Y(j-1)) with
// mu_j = (2j - 1)/j, nu_j = (1 - j)/j, w = 2/(s^2 + s), written as Y(j-1) + (1 - 1/j) (Y(j-1) - Y(j-2))
// + ..., so that a cell at rest keeps its bits.
void Avalanche::SuperStep(double rise_m, double amount) {
  int stages = 1;
  while (Reach(stages) < amount - 1e-9) ++stages;
  const double w_tau = 2 * amount / (stages * (stages + 1));
  Stage(start_, start_, 0, static_cast<float>(w_tau), rise_m, y1_);
  std::vector<float>*before = &start_, *last = &y1_, *next = &y2_;
  for (int j = 2; j <= stages; ++j) {
    const double mu = (2.0 * j - 1) / j;
    Stage(*last, *before, static_cast<float>(1 - 1.0 / j), static_cast<float>(mu * w_tau), rise_m,
          *next);
    std::vector<float>* unused = before == &start_ ? &out_ : before;
    before = last;
    last = next;
    next = unused;
  }
  // Legendre sums may undershoot; plain steps cannot.
  if (LowestIn(*last) < std::min(0.0f, LowestIn(start_)))
    PlainSteps(rise_m, amount);
  else
    std::swap(start_, *last);
}

void Avalanche::Advance(double rise_m, double amount) {
  const int count = std::max(1, static_cast<int>(std::ceil(amount / Reach(kFlowStages) - 1e-9)));
  for (int i = 0; i < count; ++i) SuperStep(rise_m, amount / count);
}

void Avalanche::Flow(double tan_angle, double amount, std::span<const CellFace> closed) {
  if (active_.empty()) return;
  const double rise_m = tan_angle * map_.cell_size_m;
  Load(active_, closed, rise_m);
  active_ = FindSteep(rise_m * (1 + kFlowTolerance)).where;
  if (active_.empty()) return;
  Advance(rise_m * (1 + kRoundingSlack), amount);
  Store(rise_m);
}

void Avalanche::Settle(double tan_angle) {
  const double rise_m = tan_angle * map_.cell_size_m;
  active_ = touched_;
  for (bool everywhere = true; !active_.empty();) {
    Load(active_, {}, rise_m);
    const Steepness steep = FindSteep(rise_m * (1 + kRestTolerance));
    active_ = steep.where;
    if (active_.empty()) {
      if (everywhere) return;
      active_ = touched_;  // faces at the edge of a window go unseen while it moves
      everywhere = true;
      continue;
    }
    everywhere = false;
    if (steep.steepest > kPlainAbove * kPlainAbove * rise_m * rise_m)
      PlainSteps(rise_m * (1 + kRoundingSlack), kMargin * kPlainStep);
    else
      SuperStep(rise_m * (1 + kRoundingSlack), Reach(kSettleStages));
    Store(rise_m);
  }
}

void RelaxToRepose(HeightMap& map, double repose_deg) {
  if (!(repose_deg >= 5 && repose_deg <= 60))
    throw Error(fmt::format("angle of repose = {} degrees; allowed: 5..60", repose_deg));
  CheckHeightMap(map, "terrain");
  std::vector<size_t> all(map.size());
  std::iota(all.begin(), all.end(), size_t{0});
  Avalanche avalanche(map);
  avalanche.Disturb(all);
  avalanche.Settle(std::tan(repose_deg * std::numbers::pi / 180));
}

}  // namespace sandwright
