// sandwright bench: speed, and speed against error, side by side on this machine.
#include <spdlog/fmt/fmt.h>

#include "cli/command.h"
#include "data/base/machine.h"
#include "data/stroke_dataset.h"
#include "env/grain_checks.h"
#include "env/sand_bench.h"

namespace sandwright {
namespace {

std::string Cell(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

class BenchCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--suite", suite_, "what to measure: sand, grains (slow; needs LAMMPS), or all")
        ->check(CLI::IsMember({"sand", "grains", "all"}))
        ->capture_default_str();
    app.add_option("--data", data_, "stroke files or folders: errors on recorded strokes too");
  }
  void Fields(FieldList& f) override {
    f.Section("heightfield", bench_.heightfield);
    f.Section("dem", bench_.dem);
  }

  int Run() override {
    bench_.threads = threads();
    if (!data_.empty()) bench_.data = FindStrokeFiles(data_);
    if (suite_ != "grains") RunSand();
    if (suite_ != "sand") RunGrains();
    WriteResult({{"rows", rows_}});
    return 0;
  }

 private:
  void RunSand() {
    PrintSandHead();
    RunSandBench(bench_, [this](const SandBenchRow& row) { Add("sand", row); });
  }

  void RunGrains() {
    fmt::print("{:62} {:>10} {:>8} {:>8} {:6} {:>5} {:>7}\n", "grains", "measured", "low", "high",
               "unit", "holds", "s");
    RunGrainChecks(bench_.dem, [this](const GrainCheck& check, double s) { Add(check, s); });
    if (bench_.data.empty()) return;
    PrintSandHead();
    RunGrainSizes(bench_, [this](const SandBenchRow& row) { Add("grains", row); });
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

  std::string suite_ = "sand";
  std::vector<std::string> data_;
  SandBench bench_;
  nlohmann::json rows_ = nlohmann::json::array();
};

}  // namespace

std::unique_ptr<Command> MakeBenchCommand() { return std::make_unique<BenchCommand>(); }

}  // namespace sandwright
