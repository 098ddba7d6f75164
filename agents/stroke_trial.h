// What strokes would be worth, tried on copies of an episode's true sand: how training looks ahead.
#pragma once

#include <span>
#include <vector>

#include "env/episode.h"

namespace sandwright {

struct StrokeTrial {
  std::vector<Stroke> stroke;
  std::vector<double> reward;  // as the environment would give it, were no stroke refused
};
StrokeTrial TryStrokes(const World& world, const EpisodeConfig& config, const EpisodeState& state,
                       std::span<const Action> actions);

}  // namespace sandwright
