#include "env/random_steps.h"

#include <algorithm>
#include <cmath>

#include "data/base/stop.h"

namespace sandwright {
namespace {

void Look(const ObservationBatch& seen, const ObservationSpec& spec, RandomStepTally& tally) {
  for (const float x : seen.map) {
    tally.not_finite += !std::isfinite(x);
    tally.out_of_bounds += std::abs(x) > spec.map_limit;
  }
  for (const float x : seen.vec) {
    tally.not_finite += !std::isfinite(x);
    tally.out_of_bounds += x < 0 || x > spec.vec_high;
  }
}

}  // namespace

nlohmann::json RandomStepTally::ToJson() const {
  return {{"steps", steps},           {"rejected", rejected},
          {"episodes", episodes},     {"not_finite", not_finite},
          {"out_of_bounds", out_of_bounds}, {"potential_mm", potential_mm},
          {"sound", sound()}};
}

RandomStepTally RunRandomSteps(ShapingEnv& env, int64_t steps, uint64_t seed) {
  RandomStepTally tally;
  const ObservationSpec& spec = env.observation_spec();
  RandomStream stream(seed, StreamId("random steps"));
  std::vector<float> actions(static_cast<size_t>(env.num_envs() * kActionSize));
  std::vector<double> progress(static_cast<size_t>(env.num_envs()));
  Look(env.Reset(seed), spec, tally);
  while (tally.steps < steps) {
    ThrowIfStopRequested();
    for (float& a : actions) a = static_cast<float>(stream.Uniform(-1, 1));
    const StepBatch step = env.Step(actions);
    Look(step.observation, spec, tally);
    Look(step.final_observation, spec, tally);
    auto summary = step.finished.begin();
    for (size_t i = 0; i < progress.size(); ++i) {
      tally.not_finite += !std::isfinite(step.reward[i]);
      tally.rejected += !env.results()[i]->accepted();
      progress[i] += env.results()[i]->reward.progress;
      if (!step.terminated[i] && !step.truncated[i]) continue;
      const auto& metrics = summary++->metrics;
      const double drop_mm =
          metrics.at("in_goal_mean_diff_start_mm") - metrics.at("in_goal_mean_diff_mm");
      tally.potential_mm = std::max(tally.potential_mm, std::abs(progress[i] - drop_mm));
      progress[i] = 0;
      ++tally.episodes;
    }
    tally.steps += env.num_envs();
  }
  return tally;
}

}  // namespace sandwright
