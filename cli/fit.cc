// sandwright fit: trains a surrogate on recorded strokes.
#include <cstdio>

#include "cli/command.h"
#include "data/base/atomic_file.h"
#include "data/stroke_dataset.h"
#include "env/fit_surrogate.h"

namespace sandwright {
namespace {

class FitCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--data", data_, "stroke files or folders to train on")->required();
    app.add_option("--validation", validation_,
                   "stroke files or folders of other beds, for early stopping");
    app.add_option("--init", init_, "start from this surrogate")->check(CLI::ExistingFile);
    app.add_option("--out", out_, "surrogate to write (.safetensors)")->required();
  }
  void Fields(FieldList& f) override { config_.Fields(f); }

  int Run() override {
    if (!out_.ends_with(".safetensors"))
      throw Error("--out " + out_ + ": the name must end in .safetensors");
    { const AtomicFile probe(out_); }  // says so before the training where it cannot be written
    FitRequest request;
    request.data = FindStrokeFiles(data_);
    if (!validation_.empty()) request.validation = FindStrokeFiles(validation_);
    if (!init_.empty()) request.init = init_;
    request.seed = seed();
    request.threads = threads();
    const FitReport report = FitSurrogate(config_, request);
    WriteSafetensors(report.model, out_);
    nlohmann::json json = report.ToJson();
    json["out"] = out_;
    std::printf("%s: %d strokes, best of %d epochs is %d, training RMSE %.2f mm", out_.c_str(),
                report.strokes, report.epochs, report.best_epoch, report.train_rmse_mm);
    if (report.validation_rmse_mm)
      std::printf(", validation RMSE %.2f mm (heightfield %.2f mm)", *report.validation_rmse_mm,
                  *report.validation_heightfield_rmse_mm);
    std::printf("\n");
    WriteResult(json);
    return report.stopped ? 130 : 0;
  }

 private:
  std::vector<std::string> data_, validation_;
  std::string init_, out_;
  FitConfig config_;
};

}  // namespace

std::unique_ptr<Command> MakeFitCommand() { return std::make_unique<FitCommand>(); }

}  // namespace sandwright
