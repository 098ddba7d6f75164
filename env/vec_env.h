// What a trainer sees: a batch of environments stepped together.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace sandwright {

// Shapes and meanings, declared once; networks and documents are
// built from it. A part may be empty.
struct ObservationSpec {
  std::vector<std::string> channels;  // of `map`, C of them
  int rows = 0, columns = 0;          // H, W of `map`
  std::vector<std::string> numbers;   // of `vec`, V of them
  float map_limit = 50;               // |map| is at most this (heights: metres of sand)
  float vec_low = 0, vec_high = 1000;  // vec lies between them
  int map_size() const { return static_cast<int>(channels.size()) * rows * columns; }
  int vec_size() const { return static_cast<int>(numbers.size()); }
};

struct ObservationBatch {
  std::vector<float> map;  // [N, C, H, W]
  std::vector<float> vec;  // [N, V]
};

// One finished episode.
struct EpisodeSummary {
  double episode_return = 0;
  int length = 0;
  std::map<std::string, double> metrics;  // e.g. "in_goal_mean_diff_mm"
};

// Result of one step of all N. Finished rows are reset in the same step: `observation` then shows
// the new episode and `final_observation` (same layout, other rows zero) the last of the old one,
// whose value is bootstrapped where the episode was truncated and is zero where it terminated.
struct StepBatch {
  ObservationBatch observation, final_observation;
  std::vector<float> reward;        // [N]
  std::vector<uint8_t> terminated;  // [N] the task itself ended
  std::vector<uint8_t> truncated;   // [N] cut off from outside
  std::vector<EpisodeSummary> finished;
};

class VecEnv {
 public:
  virtual ~VecEnv() = default;
  virtual int num_envs() const = 0;
  virtual const ObservationSpec& observation_spec() const = 0;
  virtual int action_size() const = 0;  // Box(-1, 1)^action_size, or 1 for a choice
  // Where not 0, the action is one whole number in 0..choices - 1.
  virtual int choices() const { return 0; }
  // Starts all episodes anew from `seed`; the same seed gives the same bytes.
  virtual ObservationBatch Reset(uint64_t seed) = 0;
  virtual StepBatch Step(std::span<const float> action_na) = 0;  // [N, action_size]
};

}  // namespace sandwright
