#include "env/kernel_density.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "data/base/error.h"

namespace sandwright {

KernelDensity::KernelDensity(std::span<const double> values)
    : sorted_(values.begin(), values.end()) {
  SAND_CHECK(!values.empty());
  std::ranges::sort(sorted_);
  const double count = static_cast<double>(sorted_.size());
  const double mean = std::reduce(sorted_.begin(), sorted_.end()) / count;
  double variance = 0;
  for (double v : sorted_) variance += (v - mean) * (v - mean) / std::max(count - 1, 1.0);
  const auto quantile = [&](double q) {
    const double position = q * (count - 1);
    const auto i = static_cast<size_t>(position);
    const size_t next = std::min(i + 1, sorted_.size() - 1);
    return sorted_[i] + (position - static_cast<double>(i)) * (sorted_[next] - sorted_[i]);
  };
  const double spread = (quantile(0.75) - quantile(0.25)) / 1.34;
  const double deviation = std::sqrt(variance);
  const double scale = spread > 0 ? std::min(deviation, spread) : deviation;
  bandwidth_ = 0.9 * scale * std::pow(count, -0.2);
}

double KernelDensity::At(double x) const {
  SAND_CHECK(bandwidth_ > 0);
  double sum = 0;
  for (double v : sorted_) sum += std::exp(-0.5 * std::pow((x - v) / bandwidth_, 2));
  return sum / (static_cast<double>(sorted_.size()) * bandwidth_ * std::sqrt(2 * std::numbers::pi));
}

double KernelDensity::Mode() const {
  if (!(bandwidth_ > 0)) return sorted_.front();
  constexpr int kPoints = 512;
  double best = sorted_.front(), best_density = -1;
  for (int i = 0; i < kPoints; ++i) {
    const double x = sorted_.front() + (sorted_.back() - sorted_.front()) * i / (kPoints - 1);
    const double density = At(x);
    if (density > best_density) best_density = density, best = x;
  }
  return best;
}

}  // namespace sandwright
