#include "env/avalanche.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "env/avalanche_kernel.h"

namespace sandwright {
namespace {

// Explicit steps are stable up to 1/4; each cell then gives at most four times that share of its
// height, so none goes below the floor.
constexpr double kPlainStep = 0.24;
// Longer Legendre sums are faster and distort what is steep, and what comes to rest stays distorted. So at
// rest they are the shorter the steeper the slopes are, over the critical one; steeper still, plain steps
// (tests/support/reference_avalanche.h).
constexpr int kFlowStages = 16, kGentleStages = 9, kSettleStages = 5, kPlainStages = 9;
constexpr double kGentleBelow = 1.05, kPlainAbove = 1.14;
constexpr double Reach(int stages) { return kPlainStep * stages * (stages + 1) / 2; }
// Share by which a slope must pass the angle to count as still flowing.
constexpr double kTolerance = 1e-3;
// Above the rounding of slopes in float, so that a slope exactly at the angle does not creep.
constexpr double kRoundingSlack = 2e-5;
// Change of a firm cell, as a share of the critical rise, that makes it loose.
constexpr double kLoosening = 1e-2;

float LowestIn(const std::vector<float>& heights) {
  return LowestHeight(heights.data(), static_cast<int>(heights.size()));
}

}  // namespace

Avalanche::Avalanche(const HeightMap& before, HeightMap& map, double firmness)
    : map_(map), firm_(before, firmness) {
  SAND_CHECK(before.SameGrid(map));
}

void Avalanche::Disturb(std::span<const size_t> cells) {
  if (cells.empty()) return;
  int row0 = map_.rows, row1 = 0, column0 = map_.columns, column1 = 0;
  for (const size_t cell : cells) {
    firm_.loose()[cell] = 1;
    const auto index = static_cast<int>(cell);
    const int row = index / map_.columns, column = index % map_.columns;
    row0 = std::min(row0, row), row1 = std::max(row1, row + 1);
    column0 = std::min(column0, column), column1 = std::max(column1, column + 1);
  }
  active_ = Union(active_, {row0, column0, row1, column1});
  touched_ = Union(touched_, active_);
}

AvalancheWindow Avalanche::Window(double rise_m) {
  return {window_.rows(),   window_.columns(),
          stride_,          open_x_.data(),
          open_y_.data(),   mask_row0_,
          mask_row1_,       resist_x_.data(),
          resist_y_.data(), static_cast<float>(rise_m),
          flux_.data()};
}

void Avalanche::Load(std::span<const CellFace> closed, double rise_m) {
  window_ = {std::max(active_.row0 - kMargin, 0), std::max(active_.column0 - kMargin, 0),
             std::min(active_.row1 + kMargin, map_.rows),
             std::min(active_.column1 + kMargin, map_.columns)};
  stride_ = AvalancheWindow::Stride(window_.columns());
  const size_t size = static_cast<size_t>(stride_) * static_cast<size_t>(window_.rows() + 2);
  for (std::vector<float>* y : {&start_, &resist_x_, &resist_y_}) y->resize(size);
  const size_t marks =
      static_cast<size_t>(MarkStride(window_.columns())) * static_cast<size_t>(window_.rows() + 1);
  near_.resize(marks);
  moving_.resize(marks);
  flux_.resize(3 * static_cast<size_t>(stride_));
  spans_.resize(static_cast<size_t>(window_.rows()));
  for (int row = -1; row <= window_.rows(); ++row) {
    const float* source =
        &map_.height_m[map_.Index(std::clamp(window_.row0 + row, 0, map_.rows - 1), 0)];
    float* target = &start_[static_cast<size_t>((row + 1) * stride_)];
    target[0] = source[std::max(window_.column0 - 1, 0)];
    std::copy(source + window_.column0, source + window_.column1, target + 1);
    target[window_.columns() + 1] = source[std::min(window_.column1, map_.columns - 1)];
  }
  firm_.Resist(window_, rise_m, stride_, resist_x_, resist_y_);

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

// Finds what is steep (`active_`) and what may move with it. Returns the steepest slope over the critical one,
// squared.
float Avalanche::FindMoving(double rise_m) {
  const AvalancheWindow window = Window(rise_m);
  out_.resize(start_.size());
  const float steepest = FeltSlopes(window, start_.data(), out_.data());
  const auto square = [](double x) { return static_cast<float>(x * x); };
  const float limit = square(rise_m * (1 + kTolerance));
  active_ = {};
  if (steepest > limit) {
    sandwright::FindMoving(window, out_.data(), limit, near_.data(), moving_.data(), spans_.data());
    int row0 = window_.rows(), row1 = 0, column0 = window_.columns(), column1 = 0;
    for (int row = 0; row < window_.rows(); ++row) {
      const CellSpan span = spans_[static_cast<size_t>(row)];
      if (span.empty()) continue;
      row0 = std::min(row0, row), row1 = row + 1;
      column0 = std::min(column0, span.first), column1 = std::max(column1, span.last);
    }
    reach_ = {window_.row0 + row0, window_.column0 + column0, window_.row0 + row1,
              window_.column0 + column1};
    // Steep is what lies a margin inside of that; at the window's edge it may be less.
    active_ = {reach_.row0 + (row0 > 0 ? kMargin : 0), reach_.column0 + (column0 > 0 ? kMargin : 0),
               reach_.row1 - (row1 < window_.rows() ? kMargin : 0),
               reach_.column1 - (column1 < window_.columns() ? kMargin : 0)};
    out_ = y1_ = y2_ = start_;  // what does not move stays as it is
  }
  return steepest / square(rise_m);
}

void Avalanche::Store(double rise_m) {
  const auto moved = static_cast<float>(kLoosening * rise_m);
  for (int row = 0; row < window_.rows(); ++row) {
    const CellSpan span = spans_[static_cast<size_t>(row)];
    const float* source = &start_[static_cast<size_t>((row + 1) * stride_ + 1)];
    const size_t first = map_.Index(window_.row0 + row, window_.column0);
    float* target = &map_.height_m[first];
    const float* firm = &firm_.before().height_m[first];
    uint8_t* loose = &firm_.loose()[first];
    for (int i = span.first; i < span.last; ++i) {
      if (std::abs(source[i] - firm[i]) > moved) loose[i] = 1;
      target[i] = source[i];
    }
  }
  touched_ = Union(touched_, reach_);
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
  AdvanceWindow(Window(rise_m), spans_.data(), y1.data(), y2.data(), momentum, step, out.data());
  MirrorWalls(out);
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
  Load(closed, rise_m);
  FindMoving(rise_m);
  if (active_.empty()) return;
  Advance(rise_m * (1 + kRoundingSlack), amount);
  Store(rise_m);
}

void Avalanche::Settle(double tan_angle) {
  const double rise_m = tan_angle * map_.cell_size_m;
  active_ = touched_;
  for (bool everywhere = true; !active_.empty();) {
    Load({}, rise_m);
    const float steepest = FindMoving(rise_m);
    if (active_.empty()) {
      if (everywhere) return;
      active_ = touched_;  // faces at the edge of a window go unseen while it moves
      everywhere = true;
      continue;
    }
    everywhere = false;
    const double flowing_rise_m = rise_m * (1 + kRoundingSlack);
    if (steepest > kPlainAbove * kPlainAbove)
      PlainSteps(flowing_rise_m, kPlainStages * kPlainStep);
    else
      SuperStep(flowing_rise_m,
                Reach(steepest < kGentleBelow * kGentleBelow ? kGentleStages : kSettleStages));
    Store(rise_m);
  }
}

CellRect LimitSlopes(HeightMap& map, const CellRect& rect, double tan_angle) {
  std::vector<size_t> cells;
  for (int row = rect.row0; row < rect.row1; ++row) {
    for (int column = rect.column0; column < rect.column1; ++column)
      cells.push_back(map.Index(row, column));
  }
  const HeightMap before = map;
  Avalanche avalanche(before, map, 1);
  avalanche.Disturb(cells);
  avalanche.Settle(tan_angle);
  return avalanche.touched();
}

void RelaxToRepose(HeightMap& map, double repose_deg) {
  if (!(repose_deg >= 5 && repose_deg <= 60))
    throw Error(fmt::format("angle of repose = {} degrees; allowed: 5..60", repose_deg));
  CheckHeightMap(map, "terrain");
  LimitSlopes(map, {0, 0, map.rows, map.columns}, std::tan(repose_deg * std::numbers::pi / 180));
}

}  // namespace sandwright
