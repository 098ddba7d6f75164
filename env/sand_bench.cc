#include "env/sand_bench.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <chrono>

#include "data/base/stop.h"
#include "env/dem.h"
#include "env/exact_cases.h"
#include "env/load_sand_model.h"
#include "env/score_model.h"

namespace sandwright {
namespace {

constexpr int kRuns = 7;

double BestOf_ms(int runs, const std::function<void()>& work) {
  double best_ms = std::numeric_limits<double>::max();
  for (int i = 0; i < runs; ++i) {
    ThrowIfStopRequested();
    const auto start = std::chrono::steady_clock::now();
    work();
    best_ms = std::min(
        best_ms, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
                     .count());
  }
  return best_ms;
}

// 200 mm long, 20 mm deep, through the middle of a level bed, oblique to the grid.
Stroke MiddleStroke(double width_m, double depth_m) {
  const Eigen::Vector3d middle(width_m / 2, depth_m / 2, 0.03), half(0.0866, 0.05, 0);
  return {{middle - half, middle + half}, 1, 0.1};
}

SandBenchRow TimeStroke(const HeightfieldConfig& config, const std::string& name, double box_m,
                        double cell_size_m, int batch, int threads) {
  HeightfieldConfig threaded = config;
  threaded.threads = threads;
  const Heightfield model(threaded);
  const int cells = static_cast<int>(std::lround(box_m / cell_size_m));
  const HeightMap bed(cells, cells, cell_size_m, 0.05f);
  const std::vector<SandState> start(static_cast<size_t>(batch), SandState(bed));
  const std::vector<Stroke> strokes(static_cast<size_t>(batch), MiddleStroke(box_m, box_m));
  const double ms = BestOf_ms(kRuns, [&] {
    std::vector<SandState> states = start;
    model.Apply(states, strokes);
  });
  return {.name = name,
          .threads = threads,
          .batch = batch,
          .cell_size_m = cell_size_m,
          .ms_per_stroke = ms / batch};
}

SandBenchRow RunExactCase(const ExactCase& exact, double repose_deg) {
  HeightMap map;
  const double ms = BestOf_ms(3, [&] { map = SettleCase(exact, repose_deg); });
  const CellError error = Differ(map, exact.expected);
  const double cell_mm = 1e3 * map.cell_size_m;
  return {.name = "exact: " + exact.name,
          .cell_size_m = map.cell_size_m,
          .ms_per_stroke = ms,
          .rmse_mm = cell_mm * error.rmse,
          .mae_mm = cell_mm * error.mean,
          .rmse_cells = error.rmse,
          .max_cells = error.largest};
}

SandBenchRow ScoreRow(const SandModel& model, const SandBench& bench, double model_cell_size_m) {
  ScoreConfig config;
  config.model_cell_size_m = model_cell_size_m;
  const ScoreReport report = ScoreModel(model, bench.data, config);
  const ScoreSummary total = report.Total();
  return {.name = "strokes: " + model.name(),
          .cell_size_m = report.model_cell_size_m,
          .ms_per_stroke = report.ms_per_stroke,
          .rmse_mm = total.rmse_mean_mm,
          .mae_mm = total.mae_mm,
          .r2_change = total.r2_change,
          .volume_drift_rel = total.volume_drift_rel,
          .strokes_failed = report.strokes_failed};
}

}  // namespace

nlohmann::json SandBenchRow::ToJson() const {
  nlohmann::json json = {{"name", name},
                         {"threads", threads},
                         {"batch", batch},
                         {"cell_size_m", cell_size_m},
                         {"ms_per_stroke", ms_per_stroke}};
  const auto add = [&](const char* key, const std::optional<double>& value) {
    if (value) json[key] = *value;
  };
  add("rmse_mm", rmse_mm);
  add("mae_mm", mae_mm);
  add("rmse_cells", rmse_cells);
  add("max_cells", max_cells);
  add("r2_change", r2_change);
  add("volume_drift_rel", volume_drift_rel);
  if (r2_change) json["strokes_failed"] = strokes_failed;
  return json;
}

void RunSandBench(const SandBench& bench, const std::function<void(const SandBenchRow&)>& done) {
  const HeightfieldConfig& config = bench.heightfield;
  for (const ExactCase& exact : ExactCases(config.repose_deg, 1e-3))
    done(RunExactCase(exact, config.repose_deg));
  for (const double cell_size_m : {0.01, 0.005, 0.0025, 0.002})
    done(TimeStroke(config, "200 mm stroke, box 0.6 m", 0.6, cell_size_m, 1, 1));
  for (const double box_m : {0.3, 1.2, 5.0})
    done(TimeStroke(config, fmt::format("200 mm stroke, box {:g} m", box_m), box_m, 0.005, 1, 1));
  for (int threads = 1; threads <= bench.threads; threads *= 2)
    done(TimeStroke(config, "batch of 200 mm strokes, box 0.6 m", 0.6, 0.005, 32, threads));
  if (bench.data.empty()) return;
  done(ScoreRow(StillSand(config.blade), bench, 0.004));
  for (const double cell_size_m : {0.01, 0.005, 0.0025, 0.00125})
    done(ScoreRow(Heightfield(config), bench, cell_size_m));
  for (const std::string& name : bench.models) {
    SandBenchRow row = ScoreRow(*LoadSandModel(name, {}), bench, 0);
    if (name != "default") row.name = "strokes: " + std::filesystem::path(name).stem().string();
    done(row);
  }
}

void RunGrainSizes(const SandBench& bench, const std::function<void(const SandBenchRow&)>& done) {
  if (bench.data.empty()) return;
  for (const double grain_m : {0.010, 0.008}) {
    DemConfig config = bench.dem;
    config.material.grain_m = grain_m;
    SandBenchRow row = ScoreRow(Dem(config), bench, 0.002);
    row.name += fmt::format(", grains of {:g} mm", 1e3 * grain_m);
    done(row);
  }
}

}  // namespace sandwright
