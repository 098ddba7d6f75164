// The scale of a task's rewards: the running deviation of their discounted sum (Engstrom et al.,
// "Implementation matters in deep policy gradients", ICLR 2020, section 3).
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <vector>

namespace sandwright {

class ReturnScaler {
 public:
  ReturnScaler(int num_envs, double gamma);

  // Takes in what T steps of N environments gave, [T * N], step-major: the sum of an environment
  // is gamma * sum + reward, and starts anew behind an episode's end.
  void Observe(std::span<const float> reward, std::span<const uint8_t> episode_end);
  // All environments begin new episodes; what was seen stays.
  void RestartEpisodes();
  // Of all sums ever (Welford, Technometrics 4, 1962); 1 before they varied.
  double deviation() const;
  // Divides by the deviation, and holds the result within +-10.
  void Scale(std::span<float> reward) const;

  // All but the sums of episodes that are going on: exact, so that a resumed run repeats.
  nlohmann::json ToJson() const;
  void FromJson(const nlohmann::json& json);

 private:
  double gamma_;
  std::vector<double> sum_;  // [N]
  double count_ = 0, mean_ = 0, squares_ = 0;
};

}  // namespace sandwright
