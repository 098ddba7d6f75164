#include "env/training_range.h"

#include <algorithm>
#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr char kTensor[] = "range.amounts";
constexpr std::array<std::string_view, 5> kAmounts = {"height", "cut", "blade", "remaining",
                                                      "change"};
constexpr double kLimitQuantile = 0.99;
// Channels are of order one: what is less than this in training is not held against a stroke.
constexpr double kLeastAmount = 0.01;

using Amounts = std::array<double, kAmounts.size()>;

Amounts Measure(const SurrogateInput& stroke) {
  const size_t plane = stroke.active.size();
  Amounts amounts;
  for (size_t a = 0; a < kAmounts.size(); ++a) {
    const auto channel = static_cast<size_t>(std::ranges::find(kSurrogateChannels, kAmounts[a]) -
                                             kSurrogateChannels.begin());
    double count = 0, squared = 0;
    for (size_t i = 0; i < plane; ++i) {
      if (!stroke.active[i]) continue;
      const double value = stroke.channels[channel * plane + i];
      squared += value * value;
      ++count;
    }
    amounts[a] = count > 0 ? std::sqrt(squared / count) : 0;
  }
  return amounts;
}

double RootMeanSquareRatio(const Amounts& amounts, std::span<const float> units) {
  double squared = 0;
  for (size_t a = 0; a < amounts.size(); ++a) squared += std::pow(amounts[a] / units[a], 2);
  return std::sqrt(squared / static_cast<double>(amounts.size()));
}

}  // namespace

TrainingRange::TrainingRange(std::span<const SurrogateInput> strokes) {
  SAND_CHECK(!strokes.empty());
  std::vector<Amounts> measured;
  for (const SurrogateInput& stroke : strokes) measured.push_back(Measure(stroke));
  const auto count = static_cast<double>(measured.size());
  for (size_t a = 0; a < kAmounts.size(); ++a) {
    double squared = 0;
    for (const Amounts& amounts : measured) squared += amounts[a] * amounts[a];
    amounts_.push_back(static_cast<float>(std::max(std::sqrt(squared / count), kLeastAmount)));
  }
  std::vector<double> distances;
  for (const Amounts& amounts : measured)
    distances.push_back(RootMeanSquareRatio(amounts, amounts_));
  std::ranges::sort(distances);
  const auto limit = static_cast<size_t>(std::ceil(kLimitQuantile * count)) - 1;
  for (float& amount : amounts_)
    amount *= static_cast<float>(std::max(distances[limit], kLeastAmount));
}

TrainingRange::TrainingRange(const Safetensors& file, const std::string& source)
    : amounts_(file.Tensor(kTensor, source).values) {
  if (amounts_.size() != kAmounts.size() ||
      !std::ranges::all_of(amounts_, [](float a) { return std::isfinite(a) && a > 0; }))
    throw Error(source + ": tensor " + kTensor + " must hold " + std::to_string(kAmounts.size()) +
                " positive values");
}

bool TrainingRange::In(const Safetensors& file) { return file.tensors.contains(kTensor); }

void TrainingRange::Save(Safetensors& file) const {
  file.tensors[kTensor] = {{static_cast<int64_t>(kAmounts.size())}, amounts_};
}

double TrainingRange::Distance(const SurrogateInput& stroke) const {
  return RootMeanSquareRatio(Measure(stroke), amounts_);
}

}  // namespace sandwright
