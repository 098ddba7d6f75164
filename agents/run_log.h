// What a training run says about itself: progress.csv and TensorBoard scalars, the same numbers
// under the names that other trainers' dashboards know.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "agents/ppo.h"
#include "data/base/tensorboard.h"

namespace sandwright {

// Tags and values of one update: rollout/ep_rew_mean, rollout/success_rate, time/fps, train/... and
// rollout/<metric> for each metric of the finished episodes. Tags of a rollout without finished
// episodes are left out.
std::map<std::string, double> ScalarsOf(const PpoReport& report, int64_t steps_per_update);

class RunLog {
 public:
  // Rows of an earlier run that lie beyond `first_step` are dropped:
  // a resumed run writes them anew.
  RunLog(const std::filesystem::path& folder, int64_t first_step);
  void Write(int64_t step, const std::map<std::string, double>& scalars);

 private:
  std::filesystem::path csv_;
  TensorboardWriter tensorboard_;
};

}  // namespace sandwright
