#include "env/grain_checks.h"

#include <chrono>
#include <utility>
#include <vector>

#include "data/base/stop.h"
#include "env/grain_slopes.h"
#include "env/grain_strokes.h"

namespace sandwright {

nlohmann::json GrainCheck::ToJson() const {
  nlohmann::json json = {{"name", name}, {"unit", unit}, {"measured", measured}};
  if (!limited()) return json;
  json["low"] = low;
  json["high"] = high;
  json["source"] = source;
  json["holds"] = holds();
  return json;
}

void RunGrainChecks(const DemConfig& config,
                    const std::function<void(const GrainCheck&, double seconds)>& done) {
  constexpr uint64_t kSeed = 1;
  const auto report = [&](const std::function<std::vector<GrainCheck>()>& scene) {
    ThrowIfStopRequested();
    const auto start = std::chrono::steady_clock::now();
    const std::vector<GrainCheck> checks = scene();
    double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (const GrainCheck& check : checks) done(check, std::exchange(seconds, 0));
  };
  const auto stop = StopRequested;
  report([&] { return std::vector{DrainedSlope(config, {0.2, 0.06, 0.1}, kSeed, stop)}; });
  report([&] { return ChannelCollapse(config, {0.08, 0.06, 0.08}, kSeed, stop); });
  report([&] { return ChannelCollapse(config, {0.06, 0.06, 0.12}, kSeed, stop); });
  report([&] { return ColumnCollapse(config, 0.08, 0.08, kSeed, stop); });
  report([&] { return std::vector{PouredCone(config, 12, kSeed, stop)}; });
  report([&] { return StrokeChecks(config, {}, kSeed, stop); });
}

}  // namespace sandwright
