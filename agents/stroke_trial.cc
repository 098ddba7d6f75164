#include "agents/stroke_trial.h"

namespace sandwright {

StrokeTrial TryStrokes(const World& world, const EpisodeConfig& config, const EpisodeState& state,
                       std::span<const Action> actions) {
  StrokeTrial trial;
  for (const Action& action : actions)
    trial.stroke.push_back(DecodeAction(action, state.sensed.map(), state.region, world.sand.blade(),
                                        config.speed_mps));
  std::vector<SandState> after(actions.size(), state.sand);
  world.sand.Apply(after, trial.stroke);
  for (const SandState& end : after)
    trial.reward.push_back(
        StrokeReward(config.reward, state.sand.map(), end.map(), state.task->goal).total());
  return trial;
}

}  // namespace sandwright
