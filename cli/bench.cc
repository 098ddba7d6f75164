// sandwright bench: speed, and speed against error, side by side on this machine.
#include <spdlog/fmt/fmt.h>

#include "cli/command.h"
#include "data/base/machine.h"
#include "data/stroke_dataset.h"
#include "env/sand_bench.h"

namespace sandwright {
namespace {

std::string Cell(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : "-";
}

class BenchCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--suite", suite_, "what to measure: sand, or all there is")
        ->check(CLI::IsMember({"sand", "all"}))
        ->capture_default_str();
    app.add_option("--data", data_, "stroke files or folders: errors on recorded strokes too");
  }
  void Fields(FieldList& f) override { f.Section("heightfield", bench_.heightfield); }

  int Run() override {
    bench_.threads = threads();
    if (!data_.empty()) bench_.data = FindStrokeFiles(data_);
    fmt::print("{:38} {:>7} {:>8} {:>5} {:>10} {:>8} {:>8} {:>10} {:>9} {:>6}\n", "sand", "cell mm",
               "threads", "batch", "ms/stroke", "RMSE mm", "MAE mm", "RMSE cells", "max cells",
               "r2");
    nlohmann::json rows = nlohmann::json::array();
    RunSandBench(bench_, [&](const SandBenchRow& row) {
      Print(row);
      rows.push_back(ToJson(row));
    });
    WriteResult({{"rows", rows}});
    return 0;
  }

 private:
  static void Print(const SandBenchRow& row) {
    fmt::print("{:38} {:7g} {:8} {:5} {:10.3f} {:>8} {:>8} {:>10} {:>9} {:>6}\n", row.name,
               1e3 * row.cell_size_m, row.threads, row.batch, row.ms_per_stroke,
               Cell(row.rmse_mm, 3), Cell(row.mae_mm, 3), Cell(row.rmse_cells, 4),
               Cell(row.max_cells, 3), Cell(row.r2_change, 3));
    std::fflush(stdout);
  }

  static nlohmann::json ToJson(const SandBenchRow& row) {
    nlohmann::json json = {{"suite", "sand"},
                           {"name", row.name},
                           {"threads", row.threads},
                           {"batch", row.batch},
                           {"cell_size_m", row.cell_size_m},
                           {"ms_per_stroke", row.ms_per_stroke}};
    const auto add = [&](const char* key, const std::optional<double>& value) {
      if (value) json[key] = *value;
    };
    add("rmse_mm", row.rmse_mm);
    add("mae_mm", row.mae_mm);
    add("rmse_cells", row.rmse_cells);
    add("max_cells", row.max_cells);
    add("r2_change", row.r2_change);
    add("volume_drift_rel", row.volume_drift_rel);
    return json;
  }

  std::string suite_ = "all";
  std::vector<std::string> data_;
  SandBench bench_;
};

}  // namespace

std::unique_ptr<Command> MakeBenchCommand() { return std::make_unique<BenchCommand>(); }

}  // namespace sandwright
