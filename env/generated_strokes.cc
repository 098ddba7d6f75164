#include "env/generated_strokes.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "data/base/random.h"

namespace sandwright {

FitStrokes GenerateStrokes(const GeneratedStrokes& config, double cell_size_m, uint64_t seed,
                           int epoch) {
  const auto cells = [&](double extent_m, const char* key) {
    const double count = extent_m / cell_size_m;
    if (std::abs(count - std::round(count)) > 1e-6)
      throw Error(fmt::format("generate.{} = {} m; must be a whole number of cells of {} m", key,
                              extent_m, cell_size_m));
    return static_cast<int>(std::round(count));
  };
  const int rows = cells(config.depth_m, "depth_m"), columns = cells(config.width_m, "width_m");
  const Heightfield heightfield(config.heightfield);
  RandomStream stream(seed, StreamId("fit.generate"), static_cast<uint64_t>(epoch));
  FitStrokes result;
  std::vector<SandState> state;
  for (int64_t i = 0; i < config.strokes; ++i) {
    const int64_t step = i % config.sequence;
    if (step == 0)
      state.assign(1,
                   SandState(GenerateTerrain(config.terrain, rows, columns, cell_size_m, stream)));
    StrokeRecord record;
    record.before = state[0].map();
    record.stroke = DrawStroke(config.excavation, record.before, stream);
    record.path = SamplePath(record.stroke, cell_size_m / 2);
    record.blade = heightfield.blade();
    record.sequence = i / config.sequence;
    record.step = step;
    heightfield.Apply(state, std::span(&record.path, 1));
    record.after = state[0].map();
    result.strokes.push_back({fmt::format("generated stroke {} of pass {}", i, epoch),
                              std::move(record), static_cast<size_t>(step)});
  }
  return result;
}

}  // namespace sandwright
