#include "agents/policy_agent.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>

#include "data/base/error.h"

namespace sandwright {
namespace {
constexpr double kSizeTolerance_m = 1e-6;
}  // namespace

ObservationTensors PolicyAgent::Observe(std::span<const TaskView> views) const {
  const ObservationSpec spec = SpecOf(card_.observation);
  const auto map_size = static_cast<size_t>(spec.map_size()),
             vec_size = static_cast<size_t>(spec.vec_size());
  ObservationBatch batch{std::vector<float>(views.size() * map_size),
                         std::vector<float>(views.size() * vec_size)};
  for (size_t i = 0; i < views.size(); ++i) {
    const Region& region = views[i].region;
    if (std::abs(region.width_m - card_.region_width_m) > kSizeTolerance_m ||
        std::abs(region.depth_m - card_.region_depth_m) > kSizeTolerance_m)
      throw Error(fmt::format(
          "policy {}: trained for a region of {:g} x {:g} m, the task's is {:g} x {:g} m "
          "(keys episode.region_width_m and episode.region_depth_m)",
          name_, card_.region_width_m, card_.region_depth_m, region.width_m, region.depth_m));
    Encode(views[i], card_.observation, batch.map.data() + i * map_size,
           batch.vec.data() + i * vec_size);
  }
  return ToTensors(batch, spec, device_);
}

std::vector<Action> PolicyAgent::Act(std::span<const TaskView> views,
                                     std::span<RandomStream> streams) {
  if (views.empty()) return {};
  const ObservationTensors observation = Observe(views);
  std::vector<Action> actions = ActionsOf(actor_.Mean(observation));
  for (size_t i = 0; i < views.size(); ++i) {
    if (views[i].rejected_in_a_row == 0) continue;
    const auto row = [&](const torch::Tensor& t) {
      return t.narrow(0, static_cast<int64_t>(i), 1);
    };
    actions[i] = ActionsOf(
        actor_.Draw({row(observation.map), row(observation.vec)}, streams.subspan(i, 1), 1))[0];
  }
  return actions;
}

std::vector<Action> PolicyAgent::Samples(const TaskView& view, RandomStream& stream,
                                         int64_t count) {
  if (count == 0) return {};
  return ActionsOf(actor_.Draw(Observe({&view, 1}), {&stream, 1}, static_cast<int>(count)));
}

}  // namespace sandwright
