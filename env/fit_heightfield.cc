#include "env/fit_heightfield.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "data/base/error.h"
#include "data/base/stop.h"
#include "data/stroke_dataset.h"
#include "env/score.h"

namespace sandwright {
namespace {

// The strokes of all files on one grid, ready to be predicted again and again.
struct GriddedStrokes {
  std::vector<SandState> before;
  std::vector<HeightMap> after;
  std::vector<ToolPath> paths;
};

GriddedStrokes OnGrid(const std::vector<StrokeFile>& files, double cell_size_m) {
  GriddedStrokes strokes;
  for (const StrokeFile& file : files) {
    for (const StrokeRecord& record : file.strokes) {
      strokes.before.emplace_back(Resample(record.before, cell_size_m));
      strokes.after.push_back(Resample(record.after, cell_size_m));
      strokes.paths.push_back(record.path);
    }
  }
  return strokes;
}

std::vector<StrokeFile> ReadAll(const std::vector<std::filesystem::path>& paths) {
  std::vector<StrokeFile> files;
  for (const auto& path : paths) files.push_back(ReadStrokeFile(path));
  return files;
}

CalibrationScore Judge(const HeightfieldConfig& config, const std::vector<GriddedStrokes>& grids,
                       int threads) {
  CalibrationScore mean;
  for (const GriddedStrokes& grid : grids) {
    ThrowIfStopRequested();
    HeightfieldConfig threaded = config;
    threaded.threads = threads;
    std::vector<SandState> states = grid.before;
    Heightfield(threaded).Apply(states, grid.paths);
    std::vector<StrokeScore> scores;
    for (size_t i = 0; i < states.size(); ++i)
      scores.push_back(
          ScoreStroke(grid.before[i].map(), grid.after[i], states[i].map(), grid.paths[i]));
    const ScoreSummary summary = Summarise(scores, 0);
    const auto share = 1 / static_cast<double>(grids.size());
    mean.r2_change += share * summary.r2_change.value_or(0);
    mean.rmse_mm += share * summary.rmse_mean_mm.value_or(0);
    mean.mae_mm += share * summary.mae_mm.value_or(0);
  }
  return mean;
}

struct Parameter {
  double* value;
  double low, high;
};

std::vector<Parameter> Find(const std::vector<std::string>& keys, const FieldList& fields) {
  std::vector<Parameter> found;
  for (const std::string& key : keys) {
    const auto field = std::ranges::find(fields.fields(), key, &Field::key);
    if (field == fields.fields().end() || !std::holds_alternative<double*>(field->target))
      throw Error(fmt::format(
          "parameters: '{}' is no number of the heightfield's; see heightfield.* in --help", key));
    found.push_back({std::get<double*>(field->target), field->low, field->high});
  }
  if (found.empty()) throw Error("parameters is empty; name at least one key of the heightfield");
  return found;
}

}  // namespace

nlohmann::json Calibration::ToJson() const {
  const auto figures = [](const CalibrationScore& s) {
    return nlohmann::json{{"r2_change", s.r2_change}, {"rmse_mm", s.rmse_mm}, {"mae_mm", s.mae_mm}};
  };
  HeightfieldConfig copy = heightfield;
  nlohmann::json json = {{"model", "heightfield"},
                         {"heightfield", sandwright::ToJson(FieldsOf(copy))},
                         {"start", figures(start)},
                         {"fitted", figures(fitted)},
                         {"evaluations", evaluations}};
  if (validation) json["validation"] = figures(*validation);
  return json;
}

Calibration CalibrateHeightfield(const CalibrationConfig& config,
                                 const std::vector<std::filesystem::path>& data,
                                 const std::vector<std::filesystem::path>& validation, int threads,
                                 const std::function<void(int, double)>& progress) {
  Calibration result;
  result.heightfield = config.heightfield;
  const FieldList fields = FieldsOf(result.heightfield);
  const std::vector<Parameter> parameters = Find(config.parameters, fields);
  const std::vector<StrokeFile> fit = ReadAll(data), held_out = ReadAll(validation);
  for (const StrokeFile& file : held_out) {
    if (std::ranges::find(fit, file.bed, &StrokeFile::bed) != fit.end())
      throw Error("bed '" + file.bed +
                  "' is in both --data and --validation; split by bed, never by stroke");
  }
  const auto on_grids = [&](const std::vector<StrokeFile>& files) {
    std::vector<GriddedStrokes> grids;
    for (const double cell_size_m : config.cell_sizes_m)
      grids.push_back(OnGrid(files, cell_size_m));
    return grids;
  };
  const std::vector<GriddedStrokes> grids = on_grids(fit);
  const auto judge = [&] {
    const CalibrationScore score = Judge(result.heightfield, grids, threads);
    progress(++result.evaluations, std::max(score.r2_change, result.fitted.r2_change));
    return score;
  };
  result.start = result.fitted = judge();
  for (double step = config.first_step; step >= config.last_step;) {
    bool improved = false;
    for (const Parameter& p : parameters) {
      for (const double factor : {1 + step, 1 / (1 + step)}) {
        const double old = *p.value;
        *p.value = std::clamp(old * factor, p.low, p.high);
        const bool new_and_allowed =
            *p.value != old && result.heightfield.loose_deg <= result.heightfield.repose_deg;
        const CalibrationScore score = new_and_allowed ? judge() : result.fitted;
        if (score.r2_change > result.fitted.r2_change) {
          result.fitted = score;
          improved = true;
          break;
        }
        *p.value = old;
      }
    }
    if (!improved) step /= 2;
  }
  if (!held_out.empty()) result.validation = Judge(result.heightfield, on_grids(held_out), threads);
  return result;
}

}  // namespace sandwright
