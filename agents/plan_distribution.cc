#include "agents/plan_distribution.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sandwright {
namespace {

size_t EntryOf(size_t number) { return number % kActionSize; }
bool IsHeading(size_t number) { return EntryOf(number) == kHeadingEntry; }

// From `from` to `to`; for a heading the shorter way round.
double Way(size_t number, double from, double to) {
  return IsHeading(number) ? std::remainder(to - from, 2.0) : to - from;
}

double Mean(size_t number, std::span<const double> values) {
  double sum = 0, x = 0, y = 0;
  for (double value : values) {
    sum += value;
    x += std::cos(std::numbers::pi * value);
    y += std::sin(std::numbers::pi * value);
  }
  if (IsHeading(number)) return std::atan2(y, x) / std::numbers::pi;
  return sum / static_cast<double>(values.size());
}

}  // namespace

PlanDistribution PlanDistribution::Fit(std::span<const JudgedPlan> plans) {
  SAND_CHECK(!plans.empty());
  PlanDistribution fit;
  const size_t numbers = plans.front().strokes.size() * kActionSize;
  for (size_t n = 0; n < numbers; ++n) {
    std::vector<double> values;
    for (const JudgedPlan& plan : plans)
      values.push_back(plan.strokes.at(n / kActionSize)[EntryOf(n)]);
    const double mean = Mean(n, values);
    double squares = 0;
    for (double value : values) squares += std::pow(Way(n, mean, value), 2);
    fit.mean.push_back(mean);
    fit.sd.push_back(std::sqrt(squares / static_cast<double>(values.size())));
  }
  return fit;
}

void PlanDistribution::Approach(const PlanDistribution& target, double kept) {
  SAND_CHECK(mean.size() == target.mean.size(), mean.size(), target.mean.size());
  for (size_t n = 0; n < mean.size(); ++n) {
    mean[n] = WithinBounds(EntryOf(n), mean[n] + (1 - kept) * Way(n, mean[n], target.mean[n]));
    sd[n] += (1 - kept) * (target.sd[n] - sd[n]);
  }
}

StrokePlan PlanDistribution::Draw(double least_sd, RandomStream& stream) const {
  StrokePlan plan(mean.size() / kActionSize);
  for (size_t n = 0; n < mean.size(); ++n)
    plan[n / kActionSize][EntryOf(n)] = WithinBounds(
        EntryOf(n), mean[n] + std::max(sd[n], least_sd) * stream.Normal());
  return plan;
}

}  // namespace sandwright
