// sandwright score: how well a sand model predicts recorded strokes.
#include <spdlog/fmt/fmt.h>

#include "cli/command.h"
#include "cli/score_report.h"
#include "data/base/atomic_file.h"
#include "data/stroke_dataset.h"
#include "env/load_sand_model.h"

namespace sandwright {
namespace {

class ScoreCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--model", model_,
                   "heightfield, dem (grains), none, default, fast, or a .safetensors file")
        ->required();
    app.add_option("--against", against_,
                   "another model: the difference in `explained`, with its interval (bootstrap)");
    app.add_option("--data", data_, "stroke files or folders")->required();
    app.add_option("--cell-size", score_.cell_size_m, "cells that errors are taken on [m]")
        ->check(CLI::Range(0.0005, 0.1))
        ->capture_default_str();
    app.add_option("--floor-mm", score_.floor_mm,
                   "noise floor of the data [mm]; else from its replicates")
        ->check(CLI::NonNegativeNumber);
    app.add_flag("--rollout", score_.rollout, "accrued error over the sequences too");
    app.add_flag("--paper", score_.paper, "the errors of Deep Sandscapes' protocol too");
    app.add_option("--pictures", score_.pictures,
                   "folder for before, truth, prediction, error (+-12 mm) of each stroke and "
                   "rmse_density.svg; with --paper also the paper's pictures, input and truth");
  }
  void Fields(FieldList& f) override {
    f.Section("score", score_);
    sand_.Fields(f);
  }

  int Run() override {
    sand_.heightfield.threads = threads();
    const auto model = LoadSandModel(model_, sand_);
    const auto rival = against_.empty() ? nullptr : LoadSandModel(against_, sand_);
    const auto files = FindStrokeFiles(data_);
    const ScoreReport report = ScoreModel(*model, files, score_);
    fmt::print("{}", DescribeScore(report));
    if (!score_.pictures.empty())
      WriteFileAtomically(std::filesystem::path(score_.pictures) / "rmse_density.svg",
                          DrawChartFile(RmseDensityChart(report)));
    nlohmann::json json = report.ToJson();
    json["threads"] = 1;  // strokes are timed one at a time
    if (rival && !report.stopped) json["against"] = Compare(report, *rival, files);
    WriteResult(json);
    return report.stopped ? 130 : 0;
  }

 private:
  nlohmann::json Compare(const ScoreReport& report, const SandModel& rival,
                         const std::vector<std::filesystem::path>& files) const {
    ScoreConfig plain = score_;
    plain.rollout = plain.paper = false;
    plain.pictures.clear();
    const ScoreReport against = ScoreModel(rival, files, plain);
    const PairedComparison comparison =
        CompareExplained(report.strokes, against.strokes, report.floor_mm, seed());
    fmt::print("{}", DescribeComparison(comparison, model_, against_));
    nlohmann::json json = comparison.ToJson();
    json["model"] = against_;
    return json;
  }

  std::string model_, against_;
  std::vector<std::string> data_;
  ScoreConfig score_;
  SandModelConfig sand_;
};

}  // namespace

std::unique_ptr<Command> MakeScoreCommand() { return std::make_unique<ScoreCommand>(); }

}  // namespace sandwright
