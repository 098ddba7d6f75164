#include "agents/random_agent.h"

namespace sandwright {

std::vector<Action> RandomAgent::Act(std::span<const TaskView> views,
                                     std::span<RandomStream> streams) {
  std::vector<Action> actions(views.size());
  for (size_t i = 0; i < views.size(); ++i)
    for (float& number : actions[i]) number = static_cast<float>(streams[i].Uniform(-1, 1));
  return actions;
}

}  // namespace sandwright
