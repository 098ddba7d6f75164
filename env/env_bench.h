// Speed of the shaping environment: rows of `bench --suite env`.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "env/sand_model_by_name.h"

namespace sandwright {

struct EnvBench {
  std::vector<std::string> worlds = {"default", "fast", "heightfield"};  // as SandModelByName takes them
  SandModelConfig sand;
  int threads = 1;     // rows for 1, 2, 4, ... up to as many
  double seconds = 2;  // of one run; the median of five counts
  int64_t random_steps = 0;  // of each scene and world, counted for what must never happen
};

// Random strokes through 32 environments of the small scene and of the whole box, behind the gate of
// the shipped workcells, with tasks made at each reset: strokes a second of the wall clock, of
// processor time, and what share of a step the parts took (sand, gate, observation; the rest is
// decoding, reward, resets); batches of 1, 8 and 128 on the small scene; then the memory of an
// environment, and RunRandomSteps with every fault of sensor and arm on. Each row is given to `done`
// as it comes. Ctrl-C throws kInterrupted.
void RunEnvBench(const EnvBench& bench, const std::function<void(const nlohmann::json&)>& done);

}  // namespace sandwright
