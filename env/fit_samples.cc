#include "env/fit_samples.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "data/base/atomic_file.h"
#include "data/base/parallel.h"
#include "data/base/sha256.h"
#include "data/stroke_dataset.h"

namespace sandwright {
namespace {

FitSample MakeSample(const StrokeRecord& record, const Heightfield& heightfield,
                     const SurrogateConfig& model, const std::string& name) {
  const Blade& blade = heightfield.blade();
  if (std::abs(record.blade.width_m - blade.width_m) > 1e-6 ||
      std::abs(record.blade.thickness_m - blade.thickness_m) > 1e-6)
    throw Error(fmt::format("{}: the blade is {} x {} m; the model is for {} x {} m", name,
                            record.blade.width_m, record.blade.thickness_m, blade.width_m,
                            blade.thickness_m));
  const HeightMap before = Resample(record.before, model.cell_size_m);
  const HeightMap truth = Resample(record.after, model.cell_size_m);
  std::vector<SandState> state{SandState(before)};
  heightfield.Apply(state, std::span(&record.path, 1));
  const HeightMap& predicted = state.front().map();

  FitSample sample{
      name,
      EncodeStroke(before, predicted, record.path, blade, model.net.multiple(), model.reach_m),
      {},
      {}};
  const CellRect& window = sample.input.window;
  if (window.empty()) throw Error(name + ": the path lies outside the box");
  sample.target.assign(static_cast<size_t>(sample.input.rows * sample.input.columns), 0.0f);
  sample.weight = sample.target;
  for (int row = window.row0; row < window.row1; ++row) {
    for (int column = window.column0; column < window.column1; ++column) {
      const size_t cell = before.Index(row, column);
      if ((!before.valid.empty() && !before.valid[cell]) ||
          (!truth.valid.empty() && !truth.valid[cell]))
        continue;
      const auto at =
          static_cast<size_t>((row - window.row0) * sample.input.columns + column - window.column0);
      sample.target[at] = static_cast<float>(
          (static_cast<double>(truth.height_m[cell]) - predicted.height_m[cell]) /
          kResidualScale_m);
      sample.weight[at] = 1;
    }
  }
  return sample;
}

}  // namespace

FitSamples ReadFitSamples(const std::vector<std::filesystem::path>& files,
                          const SurrogateConfig& model, int threads) {
  const Heightfield heightfield(model.heightfield);
  FitSamples result;
  for (const auto& path : files) {
    const StrokeFile file = ReadStrokeFile(path);
    result.beds.insert(file.bed);
    result.sha256[path.filename().string()] = Sha256Hex(ReadFile(path));
    std::vector<FitSample> samples(file.strokes.size());
    ParallelFor(static_cast<int>(samples.size()), threads, [&](int index) {
      const auto i = static_cast<size_t>(index);
      samples[i] = MakeSample(file.strokes[i], heightfield, model,
                              fmt::format("{}, stroke {}", path.string(), i));
    });
    std::ranges::move(samples, std::back_inserter(result.samples));
  }
  if (!files.empty() && result.samples.empty()) throw Error("the stroke files hold no stroke");
  return result;
}

FitSample ApplySymmetry(const FitSample& sample, int symmetry) {
  SAND_CHECK(symmetry >= 0 && symmetry < 8, symmetry);
  const bool mirror_x = symmetry & 1, mirror_y = symmetry & 2, swap = symmetry & 4;
  const int rows = sample.input.rows, columns = sample.input.columns;
  FitSample out = sample;
  if (swap) std::swap(out.input.rows, out.input.columns);
  const auto turned = [&](int row, int column) {  // where a cell goes
    const int j = mirror_y ? rows - 1 - row : row, i = mirror_x ? columns - 1 - column : column;
    return static_cast<size_t>(swap ? i * rows + j : j * columns + i);
  };
  const auto turn = [&](const float* from, float* to, float sign) {
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column)
        to[turned(row, column)] = sign * from[row * columns + column];
    }
  };
  const auto plane = static_cast<size_t>(rows * columns);
  for (int c = 0; c < kSurrogateChannelCount; ++c) {
    // The direction of travel is a vector: it turns with the picture.
    const bool is_x = c == kDirectionXChannel, is_y = c == kDirectionXChannel + 1;
    const int to = swap && is_x ? c + 1 : swap && is_y ? c - 1 : c;
    const float sign = (is_x && mirror_x) || (is_y && mirror_y) ? -1.0f : 1.0f;
    turn(&sample.input.channels[static_cast<size_t>(c) * plane],
         &out.input.channels[static_cast<size_t>(to) * plane], sign);
  }
  turn(sample.target.data(), out.target.data(), 1);
  turn(sample.weight.data(), out.weight.data(), 1);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column)
      out.input.active[turned(row, column)] =
          sample.input.active[static_cast<size_t>(row * columns + column)];
  }
  return out;
}

}  // namespace sandwright
