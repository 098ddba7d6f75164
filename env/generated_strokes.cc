#include "env/generated_strokes.h"

#include <algorithm>
#include <string>

#include "data/base/random.h"

namespace sandwright {

FitStrokes GenerateStrokes(const GeneratedStrokes& config, double cell_size_m, uint64_t seed,
                           int epoch) {
  RandomStream stream(seed, StreamId("fit.generate"), static_cast<uint64_t>(epoch));
  FitStrokes result;
  while (static_cast<int64_t>(result.strokes.size()) < config.strokes) {
    const int64_t left = config.strokes - static_cast<int64_t>(result.strokes.size());
    size_t behind = 0;
    for (StrokeRecord& record : DrawHeightfieldStrokes(config.drawn, cell_size_m,
                                                       std::min(config.sequence, left), stream)) {
      const std::string name = "generated stroke " + std::to_string(result.strokes.size()) +
                               " of pass " + std::to_string(epoch);
      result.strokes.push_back({name, std::move(record), behind++});
    }
  }
  return result;
}

}  // namespace sandwright
