#include "data/steepness_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sandwright {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;

constexpr int kHalfStretch = 4;

}  // namespace

std::vector<SteepPoint> SteepPoints(const LevelImage& image) {
  const int64_t width = image.camera.width, height = image.camera.height;
  std::vector<SteepPoint> points;
  points.reserve(image.points_L.size());
  const auto at = [&](int64_t u, int64_t v) -> const Vector3f& {
    return image.points_L[static_cast<size_t>(v * width + u)];
  };
  for (int64_t v = 1; v + 1 < height; ++v) {
    for (int64_t u = 1; u + 1 < width; ++u) {
      const Vector3f& p = at(u, v);
      const Vector3f a = at(u + 1, v) - at(u - 1, v), b = at(u, v + 1) - at(u, v - 1);
      if (!(p.allFinite() && a.allFinite() && b.allFinite())) continue;
      // The plane through both differences; where it stands upright in plan, the cap holds.
      const float area = std::abs(a.x() * b.y() - a.y() * b.x());
      const float rise = std::hypot(a.z() * b.y() - b.z() * a.y(), a.x() * b.z() - b.x() * a.z());
      points.push_back({p.head<2>(), rise < kSteepnessCap * area ? rise / area : kSteepnessCap});
    }
  }
  return points;
}

SteepnessPlan::SteepnessPlan(const std::vector<SteepPoint>& points, const Vector2d& middle,
                             double reach_m, double angle_rad, double cell_m)
    : cell_m_(cell_m), cells_(static_cast<int>(2 * reach_m / cell_m)) {
  axes_ << std::cos(angle_rad), std::sin(angle_rad), -std::sin(angle_rad), std::cos(angle_rad);
  low_ = axes_ * middle - Vector2d::Constant(reach_m);
  const auto n = static_cast<size_t>(cells_);
  std::vector<float> sum(n * n, 0);
  std::vector<int> count(n * n, 0);
  const Eigen::Matrix2f turn = (axes_ / cell_m).cast<float>();
  const Eigen::Vector2f shift = (low_ / cell_m).cast<float>();
  for (const SteepPoint& point : points) {
    const Eigen::Vector2f cell = turn * point.xy - shift;
    if (cell.minCoeff() < 0 || cell.maxCoeff() >= static_cast<float>(cells_)) continue;
    const size_t i = static_cast<size_t>(cell.x()) * n + static_cast<size_t>(cell.y());
    sum[i] += point.steepness;
    ++count[i];
  }
  AddLines(0, sum, count);
  AddLines(1, sum, count);
}

int SteepnessPlan::Cell(const Vector2d& xy, int axis) const {
  return static_cast<int>((axes_.row(axis).dot(xy) - low_[axis]) / cell_m_);
}

void SteepnessPlan::AddLines(int axis, const std::vector<float>& sum,
                             const std::vector<int>& count) {
  const auto n = static_cast<size_t>(cells_);
  const size_t across = axis == 0 ? n : 1, step = axis == 0 ? 1 : n;
  // Means over the stretches along each line of cells; -1: not seen.
  std::vector<float> stretch(n * n, -1);
  for (size_t line = 0; line < n; ++line) {
    float total = 0;
    int readings = 0;
    const auto add = [&](int along, int sign) {
      if (along < 0 || along >= cells_) return;
      const size_t i = line * across + static_cast<size_t>(along) * step;
      total += static_cast<float>(sign) * sum[i];
      readings += sign * count[i];
    };
    for (int along = 0; along < kHalfStretch; ++along) add(along, 1);
    for (int along = 0; along < cells_; ++along) {
      add(along + kHalfStretch, 1);
      add(along - kHalfStretch - 1, -1);
      if (readings > 0)
        stretch[line * n + static_cast<size_t>(along)] = total / static_cast<float>(readings);
    }
  }
  std::vector<float>&steepness = steepness_[static_cast<size_t>(axis)],
  &seen = seen_[static_cast<size_t>(axis)];
  steepness.assign(n * (n + 1), 0);
  seen.assign(n * (n + 1), 0);
  for (int line = 0; line < cells_; ++line) {
    for (int along = 0; along < cells_; ++along) {
      float steepest = -1;
      for (int k = std::max(line - 1, 0); k <= std::min(line + 1, cells_ - 1); ++k)
        steepest =
            std::max(steepest, stretch[static_cast<size_t>(k) * n + static_cast<size_t>(along)]);
      steepness[Index(line, along + 1)] = steepness[Index(line, along)] + std::max(steepest, 0.0f);
      seen[Index(line, along + 1)] = seen[Index(line, along)] + static_cast<float>(steepest >= 0);
    }
  }
}

double SteepnessPlan::LineSteepness(int axis, int cell, int from, int to) const {
  const auto &steepness = steepness_[static_cast<size_t>(axis)],
             &seen = seen_[static_cast<size_t>(axis)];
  const float cells_seen = seen[Index(cell, to + 1)] - seen[Index(cell, from)];
  if (2 * cells_seen < static_cast<float>(to - from + 1))
    return std::numeric_limits<double>::quiet_NaN();
  return (steepness[Index(cell, to + 1)] - steepness[Index(cell, from)]) / cells_seen;
}

}  // namespace sandwright
