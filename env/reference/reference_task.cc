#include "env/reference/reference_task.h"

#include <spdlog/fmt/fmt.h>

#include "data/base/error.h"

namespace sandwright {

std::unique_ptr<ReferenceTask> MakeReferenceTask(const std::string& name) {
  if (name == "Acrobot-v1") return MakeAcrobot();
  if (name == "CartPole-v1") return MakeCartPole();
  if (name == "MountainCarContinuous-v0") return MakeMountainCarContinuous();
  if (name == "Pendulum-v1") return MakePendulum();
  throw Error("unknown task '" + name +
              "'; allowed: Acrobot-v1, CartPole-v1, MountainCarContinuous-v0, Pendulum-v1");
}

int ChoiceOf(float action, const ReferenceSpec& spec) {
  for (int choice = 0; choice < spec.choices; ++choice) {
    if (action == static_cast<float>(choice)) return choice;
  }
  throw Error(fmt::format("{}: action {}; allowed: 0..{}, whole", spec.name, action, spec.choices - 1));
}

}  // namespace sandwright
