// sandwright score: how well a sand model predicts recorded strokes.
#include <spdlog/fmt/fmt.h>

#include <cstdio>

#include "cli/command.h"
#include "data/stroke_dataset.h"
#include "env/load_sand_model.h"
#include "env/score_model.h"

namespace sandwright {
namespace {

std::string Text(const nlohmann::json& number, int decimals) {
  return number.is_number() ? fmt::format("{:.{}f}", number.get<double>(), decimals) : "-";
}

class ScoreCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--model", model_, "heightfield, dem (grains), none, default, or a .safetensors file")
        ->required();
    app.add_option("--data", data_, "stroke files or folders")->required();
    app.add_option("--cell-size", score_.cell_size_m, "cells that errors are taken on [m]")
        ->check(CLI::Range(0.0005, 0.1))
        ->capture_default_str();
    app.add_option("--floor-mm", floor_mm_,
                   "noise floor of the data [mm]; else from its replicates")
        ->check(CLI::NonNegativeNumber);
    app.add_flag("--rollout", score_.rollout, "accrued error over the sequences too");
    app.add_flag("--paper", score_.paper, "the errors of Deep Sandscapes' protocol too");
    app.add_option("--pictures", score_.pictures,
                   "folder for before, truth, prediction, error (+-12 mm); with --paper also the "
                   "paper's pictures, input and truth");
  }
  void Fields(FieldList& f) override {
    f.Section("score", score_);
    sand_.Fields(f);
  }

  int Run() override {
    if (floor_mm_ >= 0) score_.floor_mm = floor_mm_;
    sand_.heightfield.threads = threads();
    const auto model = LoadSandModel(model_, sand_);
    const ScoreReport report = ScoreModel(*model, FindStrokeFiles(data_), score_);
    nlohmann::json json = report.ToJson();
    json["threads"] = 1;  // strokes are timed one at a time
    std::printf(
        "%s on %d strokes, cells of %g mm: MAE %s mm, RMSE %s mm (mode %s), worst cell %s mm on "
        "average,\n"
        "  r2_change %s, explained %s (floor %s mm, %s), volume drift %s, %.2f ms a stroke\n",
        report.model.c_str(), json["strokes"].get<int>(), report.cell_size_m * 1e3,
        Text(json["mae_mm"], 2).c_str(), Text(json["rmse_mean_mm"], 2).c_str(),
        Text(json["rmse_mode_mm"], 2).c_str(), Text(json["mean_max_abs_mm"], 1).c_str(),
        Text(json["r2_change"], 3).c_str(), Text(json["explained"], 3).c_str(),
        Text(json["floor_mm"], 2).c_str(), report.floor_source.c_str(),
        Text(json["volume_drift_rel"], 3).c_str(), report.ms_per_stroke);
    if (report.strokes_failed > 0)
      std::printf("  %d strokes left out: grains were lost in them\n", report.strokes_failed);
    for (const auto& [step, rmse_mm] : report.accrued_rmse_mm)
      std::printf("  accrued RMSE after %d strokes: %.2f mm\n", step, rmse_mm);
    if (report.paper_mae_mm)
      std::printf("  paper's protocol: MAE %.2f mm, RMSE (mode) %.2f mm, mean of maxima %.1f mm\n",
                  *report.paper_mae_mm, *report.paper_rmse_mode_mm, *report.paper_mean_max_mm);
    WriteResult(json);
    return report.stopped ? 130 : 0;
  }

 private:
  std::string model_;
  std::vector<std::string> data_;
  double floor_mm_ = -1;  // negative: not given
  ScoreConfig score_;
  SandModelConfig sand_;
};

}  // namespace

std::unique_ptr<Command> MakeScoreCommand() { return std::make_unique<ScoreCommand>(); }

}  // namespace sandwright
