#include "env/heightfield_strokes.h"

namespace sandwright {

StrokeRecord DrawHeightfieldStroke(const HeightfieldStrokesConfig& config, RandomStream stream) {
  const int rows = WholeCells(config.depth_m, config.cell_size_m, "depth_m"),
            columns = WholeCells(config.width_m, config.cell_size_m, "width_m");
  StrokeRecord record;
  record.before = GenerateTerrain(config.terrain, rows, columns, config.cell_size_m, stream);
  record.stroke = DrawStroke(config.excavation, record.before, stream);
  record.path = SamplePath(record.stroke, config.cell_size_m / 2);
  record.blade = config.heightfield.blade;
  SandState state(record.before);
  Heightfield(config.heightfield).Apply(std::span(&state, 1), std::span(&record.path, 1));
  record.after = state.map();
  return record;
}

}  // namespace sandwright
