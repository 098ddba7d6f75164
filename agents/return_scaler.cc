#include "agents/return_scaler.h"

#include <algorithm>
#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {
constexpr float kFarthest = 10;
}  // namespace

ReturnScaler::ReturnScaler(int num_envs, double gamma)
    : gamma_(gamma), sum_(static_cast<size_t>(num_envs)) {}

void ReturnScaler::Observe(std::span<const float> reward, std::span<const uint8_t> episode_end) {
  SAND_CHECK(reward.size() == episode_end.size() && reward.size() % sum_.size() == 0,
             reward.size(), episode_end.size());
  for (size_t i = 0; i < reward.size(); ++i) {
    double& sum = sum_[i % sum_.size()];
    sum = gamma_ * sum + reward[i];
    const double before = sum - mean_;
    mean_ += before / ++count_;
    squares_ += before * (sum - mean_);
    if (episode_end[i]) sum = 0;
  }
}

void ReturnScaler::RestartEpisodes() { std::ranges::fill(sum_, 0.0); }

double ReturnScaler::deviation() const {
  return squares_ > 0 ? std::sqrt(squares_ / count_) : 1.0;
}

void ReturnScaler::Scale(std::span<float> reward) const {
  const auto scale = static_cast<float>(1.0 / deviation());
  for (float& value : reward) value = std::clamp(value * scale, -kFarthest, kFarthest);
}

nlohmann::json ReturnScaler::ToJson() const {
  return {{"count", count_}, {"mean", mean_}, {"squares", squares_}};
}

void ReturnScaler::FromJson(const nlohmann::json& json) {
  json.at("count").get_to(count_);
  json.at("mean").get_to(mean_);
  json.at("squares").get_to(squares_);
}

}  // namespace sandwright
