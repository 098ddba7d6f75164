#include "robot_model/controller/force_guard.h"

#include <algorithm>

namespace sandwright {
namespace {

constexpr size_t kMeanKnots = 12;  // to either side: 0.2 s

}  // namespace

ForceBaseline MakeForceBaseline(std::span<const ForceSample> lifted, size_t path_begin,
                                size_t path_end) {
  const size_t knots = path_end - path_begin;
  // Sums over all knots before, so that a mean over any stretch is one difference.
  std::vector<Eigen::Vector3d> force(knots + 1, Eigen::Vector3d::Zero());
  std::vector<int> count(knots + 1, 0);
  for (const ForceSample& sample : lifted) {
    if (sample.knot < path_begin || sample.knot >= path_end) continue;
    force[sample.knot - path_begin + 1] += sample.force_n;
    ++count[sample.knot - path_begin + 1];
  }
  for (size_t i = 1; i <= knots; ++i) force[i] += force[i - 1], count[i] += count[i - 1];
  ForceBaseline baseline;
  if (count[knots] == 0) return baseline;
  for (size_t i = 0; i < knots; ++i) {
    // The arm may have passed a stretch between two samples.
    for (size_t reach = kMeanKnots;; reach *= 2) {
      const size_t from = i - std::min(i, reach), to = std::min(knots, i + reach + 1);
      if (count[to] == count[from]) continue;
      baseline.push_back((force[to] - force[from]) / (count[to] - count[from]));
      break;
    }
  }
  return baseline;
}

ForceGuard::ForceGuard(const MotionLimits& limits, ForceBaseline baseline, size_t stroke_begin,
                       size_t path_begin)
    : limits_(limits),
      baseline_(std::move(baseline)),
      stroke_begin_(stroke_begin),
      path_begin_(path_begin) {}

void ForceGuard::Take(const ForceSample& sample) {
  const bool compares = !baseline_.empty() && sample.knot >= stroke_begin_;
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  if (compares) {
    const size_t on_path = sample.knot - std::min(sample.knot, path_begin_);
    before = baseline_[std::min(on_path, baseline_.size() - 1)];
  }
  contact_n_ = (sample.force_n - before).norm();
  limit_n_ = compares ? limits_.contact_force_n
                      : limits_.pendant_force_n - MotionLimits::kPendantForceTolerance_n;
  above_ = contact_n_ > limit_n_ ? above_ + 1 : 0;
  if (above_ >= kSamples) tripped_ = true;
}

}  // namespace sandwright
