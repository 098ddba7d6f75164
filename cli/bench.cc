// sandwright bench: speed, and speed against error, side by side on this machine.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <filesystem>

#include "cli/command.h"
#include "cli/svg_chart.h"
#include "data/base/atomic_file.h"
#include "data/base/progress.h"
#include "data/stroke_dataset.h"
#include "env/grain_checks.h"
#include "env/random_strokes.h"
#include "env/sand_bench.h"

namespace sandwright {
namespace {

std::string Cell(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

class BenchCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option(
           "--suite", suites_,
           "what to measure, one or several: sand; grains (a check of the grains, slow) and coarse "
           "(coarser grains on --data, slow), which need LAMMPS; hard (random strokes); all")
        ->check(CLI::IsMember({"sand", "grains", "coarse", "hard", "all"}))
        ->capture_default_str();
    app.add_option("--data", data_, "stroke files or folders: errors on recorded strokes too");
    app.add_option("--strokes", strokes_, "random strokes of suite hard")->capture_default_str();
    app.add_option("--picture", picture_, "speed against error on --data (.svg)");
    app.add_option("--floor-mm", floor_mm_, "noise floor to draw into the picture [mm]");
  }
  void Fields(FieldList& f) override {
    f.Section("heightfield", bench_.heightfield);
    f.Section("dem", bench_.dem);
  }

  int Run() override {
    bench_.threads = threads();
    if (!data_.empty()) bench_.data = FindStrokeFiles(data_);
    if (Wants("sand")) RunSand();
    if (Wants("coarse")) RunCoarse();
    if (Wants("grains")) RunGrains();
    if (Wants("hard")) RunHard();
    if (!picture_.empty()) WriteFileAtomically(picture_, DrawChartFile(SpeedAgainstError()));
    WriteResult({{"rows", rows_}});
    return 0;
  }

 private:
  bool Wants(const char* suite) const {
    return std::ranges::any_of(suites_, [&](const auto& s) { return s == suite || s == "all"; });
  }

  void RunSand() {
    PrintSandHead();
    RunSandBench(bench_, [this](const SandBenchRow& row) { Add("sand", row); });
  }

  void RunCoarse() {
    PrintSandHead();
    RunGrainSizes(bench_, [this](const SandBenchRow& row) { Add("coarse", row); });
  }

  void RunGrains() {
    fmt::print("{:62} {:>10} {:>8} {:>8} {:6} {:>5} {:>7}\n", "grains", "measured", "low", "high",
               "unit", "holds", "s");
    RunGrainChecks(bench_.dem, [this](const GrainCheck& check, double s) { Add(check, s); });
  }

  void RunHard() {
    Progress progress("hard", static_cast<int>(strokes_), "strokes");
    const RandomStrokeTally tally =
        RunRandomStrokes(bench_.heightfield, strokes_, seed(), threads(), [&](const auto& so_far) {
          progress.Update(static_cast<int>(so_far.strokes), so_far.sound() ? "sound" : "BROKEN");
        });
    nlohmann::json row = tally.ToJson();
    fmt::print("{} random strokes: {}\n", tally.strokes, row.dump());
    row["name"] = "random strokes";
    Keep("hard", std::move(row));
  }

  // Of the rows on recorded strokes.
  Chart SpeedAgainstError() const {
    Chart chart{.x_label = "one stroke on one core [ms]",
                .y_label = "RMSE [mm]",
                .reference_y = floor_mm_,
                .reference_name = "what two packings of the same bed leave open",
                .logarithmic_x = true,
                .width_px = 760};
    const char* colours[] = {"#888888", "#1f6fb2", "#c8501e", "#2a8a4a", "#7a4fb0"};
    for (const SandBenchRow& row : strokes_rows_) {
      const std::string name = row.name.substr(row.name.find(": ") + 2);
      auto series = std::ranges::find(chart.series, name, &ChartSeries::name);
      if (series == chart.series.end()) {
        const size_t colour = chart.series.size() % std::size(colours);
        chart.series.push_back({.name = name, .colour = colours[colour]});
        series = chart.series.end() - 1;
      }
      series->x.push_back(row.ms_per_stroke);
      series->y.push_back(*row.rmse_mm);
    }
    if (chart.series.empty())
      throw Error("--picture needs errors on recorded strokes: give --data");
    return chart;
  }

  static void PrintSandHead() {
    fmt::print("{:38} {:>7} {:>8} {:>5} {:>10} {:>8} {:>8} {:>10} {:>9} {:>6}\n", "sand", "cell mm",
               "threads", "batch", "ms/stroke", "RMSE mm", "MAE mm", "RMSE cells", "max cells",
               "r2");
  }

  void Add(const char* suite, const SandBenchRow& row) {
    fmt::print("{:38} {:7g} {:8} {:5} {:10.3f} {:>8} {:>8} {:>10} {:>9} {:>6}\n", row.name,
               1e3 * row.cell_size_m, row.threads, row.batch, row.ms_per_stroke,
               Cell(row.rmse_mm, 3), Cell(row.mae_mm, 3), Cell(row.rmse_cells, 4),
               Cell(row.max_cells, 3), Cell(row.r2_change, 3));
    std::fflush(stdout);
    if (row.r2_change) strokes_rows_.push_back(row);
    Keep(suite, row.ToJson());
  }

  void Add(const GrainCheck& check, double seconds) {
    const auto limit = [&](double value) {
      return Cell(check.limited() ? std::optional(value) : std::nullopt, 3);
    };
    fmt::print("{:62} {:10.4g} {:>8} {:>8} {:6} {:>5} {:7.1f}\n", check.name, check.measured,
               limit(check.low), limit(check.high), check.unit,
               check.limited() ? (check.holds() ? "yes" : "NO") : "-", seconds);
    std::fflush(stdout);
    nlohmann::json json = check.ToJson();
    json["seconds"] = seconds;
    Keep("grains", std::move(json));
  }

  void Keep(const char* suite, nlohmann::json row) {
    row["suite"] = suite;
    rows_.push_back(std::move(row));
  }

  std::vector<std::string> suites_ = {"sand"};
  std::vector<std::string> data_;
  int64_t strokes_ = 100000;
  std::string picture_;
  std::optional<double> floor_mm_;
  std::vector<SandBenchRow> strokes_rows_;
  SandBench bench_;
  nlohmann::json rows_ = nlohmann::json::array();
};

}  // namespace

std::unique_ptr<Command> MakeBenchCommand() { return std::make_unique<BenchCommand>(); }

}  // namespace sandwright
