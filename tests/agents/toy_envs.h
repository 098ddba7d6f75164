// Small environments with known optima.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "data/base/random.h"
#include "env/vec_env.h"

namespace sandwright {

// A point on a line walks to a target: x += 0.25 a, reward = drop of the
// distance, terminated within 0.05 of the target, truncated after 12 steps. The
// best return is the first distance (to 0.05). Rewards come times `reward_unit`.
class MoveToTarget final : public VecEnv {
 public:
  explicit MoveToTarget(int num_envs, float reward_unit = 1)
      : reward_unit_(reward_unit),
        x_(num_envs),
        target_(num_envs),
        step_(num_envs),
        start_(num_envs) {
    spec_.numbers = {"x", "target"};
  }
  int num_envs() const override { return static_cast<int>(x_.size()); }
  const ObservationSpec& observation_spec() const override { return spec_; }
  int action_size() const override { return 1; }

  ObservationBatch Reset(uint64_t seed) override {
    stream_ = RandomStream(seed);
    ObservationBatch out;
    for (size_t i = 0; i < x_.size(); ++i) Begin(i), Show(i, out);
    return out;
  }

  StepBatch Step(std::span<const float> action) override {
    StepBatch out;
    for (size_t i = 0; i < x_.size(); ++i) {
      const float before = std::abs(x_[i] - target_[i]);
      x_[i] += 0.25f * action[i];
      const float after = std::abs(x_[i] - target_[i]);
      out.reward.push_back(reward_unit_ * (before - after));
      out.terminated.push_back(after < 0.05f);
      out.truncated.push_back(!out.terminated[i] && ++step_[i] == 12);
      const bool ended = out.terminated[i] || out.truncated[i];
      if (ended) {
        Show(i, out.final_observation);
        out.finished.push_back({start_[i] - after, step_[i], {{"distance", after}}});
        Begin(i);
      } else {
        out.final_observation.vec.insert(out.final_observation.vec.end(), {0.0f, 0.0f});
      }
      Show(i, out.observation);
    }
    return out;
  }

 private:
  void Begin(size_t i) {
    x_[i] = static_cast<float>(stream_.Uniform(-1, 1));
    target_[i] = static_cast<float>(stream_.Uniform(-1, 1));
    start_[i] = std::abs(x_[i] - target_[i]);
    step_[i] = 0;
  }
  void Show(size_t i, ObservationBatch& out) const {
    out.vec.insert(out.vec.end(), {x_[i], target_[i]});
  }

  float reward_unit_;
  ObservationSpec spec_;
  RandomStream stream_{0};
  std::vector<float> x_, target_;
  std::vector<int> step_;
  std::vector<double> start_;
};

// One step: a 16 x 16 map shows one or two spots; the action's first two numbers must
// hit one of them, the third the heading that is asked for (seen in `vec`; near the
// wrap of +-pi), the fourth 0.5. Reward 1 less the distance to the nearer spot, less
// a share of the other two errors: at most 1.
class HitTheSpot final : public VecEnv {
 public:
  explicit HitTheSpot(int num_envs) : num_envs_(num_envs), spots_(num_envs) {
    spec_ = {{"spots"}, kSize, kSize, {"nothing"}};
  }
  int num_envs() const override { return num_envs_; }
  const ObservationSpec& observation_spec() const override { return spec_; }
  int action_size() const override { return 4; }

  ObservationBatch Reset(uint64_t seed) override {
    stream_ = RandomStream(seed);
    return NewEpisodes();
  }

  StepBatch Step(std::span<const float> action) override {
    StepBatch out;
    out.final_observation = observation_;
    for (size_t i = 0; i < spots_.size(); ++i) {
      const float* a = action.data() + 4 * i;
      double nearest = 10;
      for (const auto& [x, y] : spots_[i])
        nearest = std::min(nearest, std::hypot(a[0] - x, a[1] - y));
      const double heading_error = 1.0 - std::abs(a[2]);  // asked for: +-pi
      const double reward = 1.0 - nearest - 0.3 * heading_error - 0.3 * std::abs(a[3] - 0.5);
      out.reward.push_back(static_cast<float>(reward));
      out.finished.push_back({reward, 1, {}});
    }
    out.terminated.assign(spots_.size(), 1);
    out.truncated.assign(spots_.size(), 0);
    out.observation = NewEpisodes();
    return out;
  }

 private:
  static constexpr int kSize = 16;
  struct Spot {
    double x, y;
  };

  ObservationBatch NewEpisodes() {
    observation_ = {std::vector<float>(spots_.size() * kSize * kSize),
                    std::vector<float>(spots_.size())};
    for (size_t i = 0; i < spots_.size(); ++i) {
      spots_[i].clear();
      const uint64_t count = 1 + stream_.Index(2);
      for (uint64_t k = 0; k < count; ++k) {
        const auto row = stream_.Index(kSize), column = stream_.Index(kSize);
        observation_.map[(i * kSize + row) * kSize + column] = 1;
        spots_[i].push_back({Middle(column), Middle(row)});
      }
    }
    return observation_;
  }
  static double Middle(uint64_t cell) {
    return (static_cast<double>(cell) + 0.5) * 2.0 / kSize - 1.0;
  }

  int num_envs_;
  ObservationSpec spec_;
  RandomStream stream_{0};
  std::vector<std::vector<Spot>> spots_;
  ObservationBatch observation_;
};

}  // namespace sandwright
