#include "env/reference/reference_task.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {

struct Entry {
  const char* name;
  std::unique_ptr<ReferenceTask> (*make)();
};

constexpr Entry kTasks[] = {{"CartPole-v1", MakeCartPole},
                            {"Acrobot-v1", MakeAcrobot},
                            {"Pendulum-v1", MakePendulum},
                            {"MountainCarContinuous-v0", MakeMountainCarContinuous},
                            {"HalfCheetah-v4", [] { return MakeHalfCheetah(4); }},
                            {"HalfCheetah-v5", [] { return MakeHalfCheetah(5); }},
                            {"Hopper-v4", [] { return MakeHopper(4); }},
                            {"Hopper-v5", [] { return MakeHopper(5); }}};

}  // namespace

std::vector<std::string> ReferenceTaskNames() {
  std::vector<std::string> names;
  for (const Entry& entry : kTasks) names.emplace_back(entry.name);
  return names;
}

std::unique_ptr<ReferenceTask> MakeReferenceTask(const std::string& name) {
  for (const Entry& entry : kTasks) {
    if (name == entry.name) return entry.make();
  }
  throw Error(fmt::format("unknown task '{}'; allowed: {}", name,
                          fmt::join(ReferenceTaskNames(), ", ")));
}

void CheckAction(const ReferenceSpec& spec, std::span<const float> action) {
  const auto end = static_cast<float>(spec.choices);
  for (const float value : action) {
    if (spec.choices == 0 && !std::isfinite(value))
      throw Error(fmt::format("{}: action {}; allowed: finite numbers", spec.name, value));
    if (spec.choices > 0 && !(value >= 0 && value < end && value == std::floor(value)))
      throw Error(fmt::format("{}: action {}; allowed: 0..{}, whole", spec.name, value, end - 1));
  }
}

}  // namespace sandwright
