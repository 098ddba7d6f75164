#include "env/heightfield_strokes.h"

namespace sandwright {

std::vector<StrokeRecord> DrawHeightfieldStrokes(const HeightfieldStrokesConfig& config,
                                                 double cell_size_m, int64_t count,
                                                 RandomStream& stream) {
  const int rows = WholeCells(config.depth_m, cell_size_m, "depth_m"),
            columns = WholeCells(config.width_m, cell_size_m, "width_m");
  const Heightfield heightfield(config.heightfield);
  SandState state(GenerateTerrain(config.terrain, rows, columns, cell_size_m, stream));
  std::vector<StrokeRecord> records;
  for (int64_t step = 0; step < count; ++step) {
    StrokeRecord record;
    record.before = state.map();
    record.stroke = DrawStroke(config.excavation, record.before, stream);
    record.path = SamplePath(record.stroke, cell_size_m / 2);
    record.blade = heightfield.blade();
    record.step = step;
    heightfield.Apply(std::span(&state, 1), std::span(&record.path, 1));
    record.after = state.map();
    records.push_back(std::move(record));
  }
  return records;
}

}  // namespace sandwright
