#include "env/score_model.h"

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>

#include "data/base/json_number.h"
#include "data/base/progress.h"
#include "data/base/stop.h"
#include "data/picture.h"
#include "data/stroke_dataset.h"
#include "env/dem.h"
#include "env/kernel_density.h"
#include "env/paper_encoding.h"
#include "env/paper_protocol.h"
#include "env/rank_correlation.h"
#include "env/score_picture.h"

namespace sandwright {
namespace {

constexpr uint64_t kPacking = 0;  // of the grains, where the model has some
constexpr double kCold_s = 1;     // a stroke that takes longer is not slower for cold caches
// The steps of `accrued_rmse_mm`, which has a line each in the output.
constexpr std::array<int, 5> kPrintedSteps = {1, 5, 20, 50, 100};

// `base` plus the change from one map to another of any cell size with the same walls.
HeightMap AddChange(HeightMap base, const HeightMap& from, const HeightMap& to) {
  HeightMap change = to;
  for (size_t i = 0; i < change.size(); ++i) change.height_m[i] -= from.height_m[i];
  if (!change.SameGrid(base)) change = Resample(change, base.cell_size_m);
  for (size_t i = 0; i < base.size(); ++i) base.height_m[i] += change.height_m[i];
  return base;
}

void CheckBlade(const SandModel& model, const Blade& blade, const std::string& where) {
  const Blade& own = model.blade();
  if (std::abs(own.width_m - blade.width_m) < 1e-6 &&
      std::abs(own.thickness_m - blade.thickness_m) < 1e-6)
    return;
  throw Error(fmt::format("{}: the blade is {} x {} m; model {} is for {} x {} m", where,
                          blade.width_m, blade.thickness_m, model.name(), own.width_m,
                          own.thickness_m));
}

class Scorer {
 public:
  Scorer(const SandModel& model, const ScoreConfig& config) : model_(model), config_(config) {
    report_.model = model.name();
    report_.cell_size_m = config.cell_size_m;
    report_.model_cell_size_m = model.cell_size_m().value_or(
        config.model_cell_size_m > 0 ? config.model_cell_size_m : config.cell_size_m);
    if (config.model_cell_size_m > 0 && config.model_cell_size_m != report_.model_cell_size_m)
      throw Error(fmt::format("model_cell_size_m = {}: model {} is bound to {} m",
                              config.model_cell_size_m, model.name(), report_.model_cell_size_m));
  }

  void AddFile(const std::filesystem::path& path) {
    const StrokeFile file = ReadStrokeFile(path);
    if (file.strokes.empty()) throw Error(path.string() + ": the file holds no stroke");
    for (size_t i = 0; i < file.strokes.size(); ++i) {
      if (Stopped()) return;
      try {
        ScoreRecord(path, file.strokes[i], static_cast<int>(i));
      } catch (const GrainsLost& error) {
        spdlog::warn("{}, stroke {} is left out: {}", path.string(), i, error.what());
        ++report_.strokes_failed;
      } catch (const Error& error) {  // a run of grains ends at once
        if (error.kind() != ErrorKind::kInterrupted) throw;
      }
    }
    AddReplicates(path, file);
    if (config_.rollout) RollOut(file);
    ++files_;
  }

  // Whether Ctrl-C was seen; the report then says so.
  bool Stopped() { return report_.stopped = report_.stopped || StopRequested(); }

  ScoreReport Finish() {
    if (report_.strokes.empty()) {
      ThrowIfStopRequested();
      throw Error(fmt::format("grains were lost in each of {} strokes", report_.strokes_failed));
    }
    const auto count = static_cast<double>(report_.strokes.size());
    report_.ms_per_stroke = seconds_ * 1e3 / count;
    report_.floor_mm = config_.floor_mm.value_or(floor_.rmse_mm());
    report_.floor_source = config_.floor_mm ? "given"
                           : floor_.pairs() > 0
                               ? fmt::format("{} pairs of replicates", floor_.pairs())
                               : "0: no replicates in the data";
    report_.floor_max_abs_mm = floor_.max_abs_mm();
    report_.accrued = rollout_.Accrued();
    report_.accrued_growth_exponent = rollout_.GrowthExponent();
    if (config_.paper) {
      report_.paper_mae_mm = paper_mae_mm_ / count;
      report_.paper_rmse_mode_mm = KernelDensity(paper_rmse_mm_).Mode();
      report_.paper_mean_max_mm = paper_max_mm_ / count;
    }
    return std::move(report_);
  }

 private:
  HeightMap OnErrorCells(const HeightMap& map) const { return Resample(map, config_.cell_size_m); }

  void ScoreRecord(const std::filesystem::path& path, const StrokeRecord& record, int index) {
    const std::string where = fmt::format("{}, stroke {}", path.string(), index);
    CheckBlade(model_, record.blade, where);
    const HeightMap terrain = Resample(record.before, report_.model_cell_size_m);
    Prediction predicted = Predict(terrain, record.path);
    // The first run only warms caches, but where it took long they do not matter.
    if (report_.strokes.empty() && predicted.seconds < kCold_s)
      predicted = Predict(terrain, record.path);
    seconds_ += predicted.seconds;

    const HeightMap before = OnErrorCells(record.before), truth = OnErrorCells(record.after);
    const HeightMap prediction = AddChange(before, predicted.start, predicted.end);
    StrokeScore score = ScoreStroke(before, truth, prediction, record.path);
    score.file = path.filename().string();
    score.file_index = files_;
    score.stroke = index;
    score.complexity = ComplexityClass(record.stroke);
    score.training_distance = predicted.training_distance;
    if (config_.paper) AddPaper(record, AddChange(record.before, predicted.start, predicted.end));
    if (!config_.pictures.empty()) Draw(score, record, before, truth, prediction);
    report_.strokes.push_back(std::move(score));
  }

  struct Prediction {
    HeightMap start, end;  // the bed that the model starts from, and what it becomes
    std::optional<double> training_distance;
    double seconds = 0;  // of the stroke; making a bed of grains does not count
  };

  Prediction Predict(const HeightMap& terrain, const ToolPath& path) const {
    SandState state = model_.Start(terrain, kPacking);
    HeightMap start = state.map();
    const auto began = std::chrono::steady_clock::now();
    const Outcome outcome = model_.Apply(std::span(&state, 1), std::span(&path, 1)).front();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    return {std::move(start), state.map(), outcome.training_distance, took.count()};
  }

  void AddPaper(const StrokeRecord& record, const HeightMap& prediction) {
    const PaperScore paper = ScorePaperCrop(record.after, prediction, record.path);
    paper_mae_mm_ += paper.mae_mm;
    paper_max_mm_ += paper.max_abs_mm;
    paper_rmse_mm_.push_back(paper.rmse_mm);
  }

  void AddReplicates(const std::filesystem::path& path, const StrokeFile& file) {
    for (size_t i = 0; i < file.strokes.size(); ++i) {
      const StrokeRecord& a = file.strokes[i];
      if (!a.replicate_of) continue;
      size_t other = 0;
      while (other < file.strokes.size() && fmt::format("{:05}", other) != *a.replicate_of) ++other;
      if (other == file.strokes.size())
        throw Error(
            fmt::format("{}: stroke {} is a replicate of '{}', which the file does not hold",
                        path.string(), i, *a.replicate_of));
      const StrokeRecord& b = file.strokes[other];
      floor_.Add(OnErrorCells(a.before), OnErrorCells(a.after), OnErrorCells(b.before),
                 OnErrorCells(b.after), a.path);
    }
  }

  // Every run of consecutive steps of one sequence.
  void RollOut(const StrokeFile& file) {
    std::optional<SandState> state;
    HeightMap start, before;
    CellRect window;
    int done = 0;
    for (size_t i = 0; i < file.strokes.size(); ++i) {
      if (Stopped()) return;
      const StrokeRecord& record = file.strokes[i];
      const bool follows = i > 0 && record.sequence == file.strokes[i - 1].sequence &&
                           record.step == file.strokes[i - 1].step + 1;
      if (!follows) {
        state = model_.Start(Resample(record.before, report_.model_cell_size_m), kPacking);
        start = state->map();
        before = OnErrorCells(record.before);
        window = {};
        done = 0;
      }
      model_.Apply(std::span(&*state, 1), std::span(&record.path, 1));
      const HeightMap prediction = AddChange(before, start, state->map());
      const HeightMap truth = OnErrorCells(record.after);
      window = Union(window, ScoreWindow(before, truth, prediction, record.path));
      rollout_.Add(++done, truth, prediction, window);
    }
  }

  void Draw(const StrokeScore& score, const StrokeRecord& record, const HeightMap& before,
            const HeightMap& truth, const HeightMap& prediction) const {
    const std::string title =
        fmt::format("{}, stroke {} (class {}), model {}: RMSE {:.2f} mm, worst cell {:.1f} mm",
                    score.file, score.stroke, score.complexity, report_.model,
                    std::sqrt(score.mse_mm2()), score.max_abs_mm);
    const cv::Mat picture = DrawScoredStroke(title, before, truth, prediction,
                                             ScoreWindow(before, truth, prediction, record.path),
                                             record.path, record.blade);
    std::filesystem::create_directories(config_.pictures);
    WritePicture(picture, PictureFile(score, ""));
    if (config_.paper) WritePair(PictureFile(score, "_paper"), record);
  }

  std::filesystem::path PictureFile(const StrokeScore& score, const char* ending) const {
    return std::filesystem::path(config_.pictures) /
           fmt::format("{}_{:05}{}.png", std::filesystem::path(score.file).stem().string(),
                       score.stroke, ending);
  }

  static void WritePair(const std::filesystem::path& file, const StrokeRecord& record) {
    const auto input = EncodePaperInput(record.before, record.path, record.blade);
    if (input) WritePaperPair(*input, EncodePaperHeight(record.after, *input), file);
  }

  const SandModel& model_;
  const ScoreConfig& config_;
  ScoreReport report_;
  NoiseFloor floor_;
  RolloutScore rollout_;
  int files_ = 0;
  double seconds_ = 0, paper_mae_mm_ = 0, paper_max_mm_ = 0;
  std::vector<double> paper_rmse_mm_;
};

}  // namespace

ScoreReport ScoreModel(const SandModel& model, std::span<const std::filesystem::path> files,
                       const ScoreConfig& config) {
  SAND_CHECK(!files.empty());
  Scorer scorer(model, config);
  Progress progress("score", static_cast<int64_t>(files.size()), "files");
  for (size_t i = 0; i < files.size() && !scorer.Stopped(); ++i) {
    scorer.AddFile(files[i]);
    progress.Update(static_cast<int64_t>(i) + 1);
  }
  return scorer.Finish();
}

std::optional<double> ScoreReport::RangeErrorCorrelation() const {
  std::vector<double> distances, rmse_mm;
  for (const StrokeScore& s : strokes) {
    if (!s.training_distance) continue;
    distances.push_back(*s.training_distance);
    rmse_mm.push_back(std::sqrt(s.mse_mm2()));
  }
  return SpearmanCorrelation(distances, rmse_mm);
}

nlohmann::json ScoreReport::ToJson() const {
  const ScoreSummary total = Total();
  nlohmann::json json = {{"model", model},
                         {"strokes", total.strokes},
                         {"strokes_failed", strokes_failed},
                         {"cell_size_m", cell_size_m},
                         {"model_cell_size_m", model_cell_size_m},
                         {"mae_mm", JsonNumber(total.mae_mm)},
                         {"rmse_mode_mm", JsonNumber(total.rmse_mode_mm)},
                         {"rmse_mean_mm", JsonNumber(total.rmse_mean_mm)},
                         {"mean_max_abs_mm", JsonNumber(total.mean_max_abs_mm)},
                         {"r2_change", JsonNumber(total.r2_change)},
                         {"explained", JsonNumber(total.explained)},
                         {"floor_mm", floor_mm},
                         {"floor_source", floor_source},
                         {"floor_max_abs_mm", JsonNumber(floor_max_abs_mm)},
                         {"floor_max_abs_single_mm",
                          floor_max_abs_mm ? nlohmann::json(*floor_max_abs_mm / std::numbers::sqrt2)
                                           : nlohmann::json()},
                         {"range_error_correlation", JsonNumber(RangeErrorCorrelation())},
                         {"volume_drift_rel", JsonNumber(total.volume_drift_rel)},
                         {"ms_per_stroke", ms_per_stroke},
                         {"stopped", stopped}};
  for (char c = 'A'; c <= 'F'; ++c) {
    std::vector<StrokeScore> of_class;
    for (const StrokeScore& s : strokes) {
      if (s.complexity == c) of_class.push_back(s);
    }
    const ScoreSummary summary = Summarise(of_class, floor_mm);
    json["by_complexity"][std::string(1, c)] = {
        {"strokes", summary.strokes},
        {"mae_mm", JsonNumber(summary.mae_mm)},
        {"rmse_mean_mm", JsonNumber(summary.rmse_mean_mm)},
        {"mean_max_abs_mm", JsonNumber(summary.mean_max_abs_mm)}};
  }
  for (const AccruedError& error : accrued) {
    json["accrued"].push_back({{"step", error.step},
                               {"sequences", error.sequences},
                               {"cells", error.cells},
                               {"rmse_mm", error.rmse_mm}});
    if (std::ranges::find(kPrintedSteps, error.step) != kPrintedSteps.end())
      json["accrued_rmse_mm"][std::to_string(error.step)] = error.rmse_mm;
  }
  if (!accrued.empty()) json["accrued_growth_exponent"] = JsonNumber(accrued_growth_exponent);
  if (paper_mae_mm) {
    json["paper_mae_mm"] = *paper_mae_mm;
    json["paper_rmse_mode_mm"] = *paper_rmse_mode_mm;
    json["paper_mean_max_mm"] = *paper_mean_max_mm;
  }
  json["per_stroke"] = nlohmann::json::array();
  for (const StrokeScore& s : strokes)
    json["per_stroke"].push_back({{"file", s.file},
                                  {"stroke", s.stroke},
                                  {"class", std::string(1, s.complexity)},
                                  {"cells", s.cells},
                                  {"mse_mm2", s.mse_mm2()},
                                  {"change_mm2", s.change_mm2 / static_cast<double>(s.cells)},
                                  {"max_abs_mm", s.max_abs_mm},
                                  {"training_distance", JsonNumber(s.training_distance)}});
  return json;
}

}  // namespace sandwright
