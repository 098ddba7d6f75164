#include "env/training_range.h"

#include <algorithm>
#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr size_t kNumbers = 2 * kSurrogateChannelCount;
// Channels are of order one: what varies less than this in training is not held against a stroke.
constexpr float kLeastDeviation = 0.01f;

std::vector<double> Describe(const SurrogateInput& stroke) {
  const size_t plane = stroke.active.size();
  std::vector<double> numbers;
  for (size_t c = 0; c < kSurrogateChannelCount; ++c) {
    double count = 0, sum = 0, squared = 0;
    for (size_t i = 0; i < plane; ++i) {
      if (!stroke.active[i]) continue;
      const double value = stroke.channels[c * plane + i];
      ++count;
      sum += value;
      squared += value * value;
    }
    const double mean = count > 0 ? sum / count : 0;
    numbers.push_back(mean);
    numbers.push_back(count > 0 ? std::sqrt(std::max(squared / count - mean * mean, 0.0)) : 0);
  }
  return numbers;
}

}  // namespace

TrainingRange::TrainingRange(const std::vector<SurrogateInput>& strokes) {
  SAND_CHECK(!strokes.empty());
  std::vector<double> sum(kNumbers, 0.0), squared(kNumbers, 0.0);
  for (const SurrogateInput& stroke : strokes) {
    const std::vector<double> numbers = Describe(stroke);
    for (size_t i = 0; i < kNumbers; ++i) {
      sum[i] += numbers[i];
      squared[i] += numbers[i] * numbers[i];
    }
  }
  const auto count = static_cast<double>(strokes.size());
  for (size_t i = 0; i < kNumbers; ++i) {
    const double mean = sum[i] / count;
    mean_.push_back(static_cast<float>(mean));
    deviation_.push_back(
        std::max(static_cast<float>(std::sqrt(std::max(squared[i] / count - mean * mean, 0.0))),
                 kLeastDeviation));
  }
}

TrainingRange::TrainingRange(const Safetensors& file, const std::string& source)
    : mean_(file.Tensor("range.mean", source).values),
      deviation_(file.Tensor("range.deviation", source).values) {
  if (mean_.size() != kNumbers || deviation_.size() != kNumbers)
    throw Error(source + ": tensors range.mean and range.deviation have another shape than [" +
                std::to_string(kNumbers) + "]");
}

void TrainingRange::Save(Safetensors& file) const {
  const auto count = static_cast<int64_t>(kNumbers);
  file.tensors["range.mean"] = {{count}, mean_};
  file.tensors["range.deviation"] = {{count}, deviation_};
}

double TrainingRange::Distance(const SurrogateInput& stroke) const {
  const std::vector<double> numbers = Describe(stroke);
  double squared = 0;
  for (size_t i = 0; i < kNumbers; ++i) {
    const double distance = (numbers[i] - mean_[i]) / deviation_[i];
    squared += distance * distance;
  }
  return std::sqrt(squared / kNumbers);
}

}  // namespace sandwright
