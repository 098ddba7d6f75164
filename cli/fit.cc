// sandwright fit: trains a surrogate or pix2pix on recorded strokes, or calibrates the heightfield.
#include <spdlog/fmt/fmt.h>

#include "cli/command.h"
#include "data/base/atomic_file.h"
#include "data/base/progress.h"
#include "data/shipped.h"
#include "data/stroke_dataset.h"
#include "env/fit_heightfield.h"
#include "env/fit_pix2pix.h"
#include "env/fit_surrogate.h"

namespace sandwright {
namespace {

class FitCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option(
           "--data", data_,
           "stroke files or folders to train on; generated: heightfield strokes of the keys "
           "generate, made anew in each pass")
        ->required();
    app.add_option("--validation", validation_,
                   "stroke files or folders of other beds: early stopping, held-out figures");
    app.add_option(
        "--init", init_,
        "start from this model: default (the shipped surrogate), or a .safetensors file");
    app.add_flag("--resume", resume_,
                 "go on with an interrupted fit of a surrogate, kept beside --out as OUT.state");
    app.add_option("--log", log_, "folder for TensorBoard events of a surrogate's fit");
    app.add_option("--out", out_,
                   "what to write: surrogate and pix2pix (.safetensors) or heightfield (.yaml)")
        ->required();
  }
  void Fields(FieldList& f) override {
    f.Add("model", model_, "what is fitted", {"surrogate", "pix2pix", "heightfield"});
    config_.Fields(f);
    f.Section("pix2pix", pix2pix_);
    f.Section("calibration", calibration_);
    UnattendedFields(f);
  }

  int Run() override {
    const std::string ending = model_ == "heightfield" ? ".yaml" : ".safetensors";
    if (!out_.ends_with(ending))
      throw Error("--out " + out_ + ": the name of a " + model_ + " must end in " + ending);
    if (model_ == "heightfield" && !init_.empty())
      throw Error("--init " + init_ +
                  ": a heightfield starts from the keys calibration.heightfield");
    if (model_ != "surrogate" && generates())
      throw Error("--data generated: only a surrogate is trained on it");
    if (resume_ && model_ != "surrogate")
      throw Error("--resume goes on with the fit of a surrogate");
    if (!log_.empty() && model_ != "surrogate")
      throw Error("--log " + log_ + ": only the fit of a surrogate writes events");
    { const AtomicFile probe(out_); }  // says so before the work where it cannot be written
    if (model_ == "pix2pix") return TrainPix2Pix();
    return model_ == "surrogate" ? Train() : Calibrate();
  }

 private:
  int Train() {
    FitRequest request;
    if (!generates()) request.data = FindStrokeFiles(data_);
    request.validation = HeldOut();
    if (!init_.empty()) {
      request.init = init_ == "default" ? ShippedFile("models/default_surrogate.safetensors")
                                        : std::filesystem::path(init_);
      TakeModelOf(*request.init);
    }
    request.seed = seed();
    request.threads = threads();
    request.state = out_ + ".state";
    request.resume = resume_;
    if (!log_.empty()) request.log = log_;
    request.status = WatchFile(out_);
    const FitReport report = FitSurrogate(config_, request);
    WriteSafetensors(report.model, out_);
    if (!report.stopped) std::filesystem::remove(*request.state);
    nlohmann::json json = report.ToJson();
    json["out"] = out_;
    std::string validation;
    if (report.validation_rmse_mm)
      validation = fmt::format(", validation RMSE {:.2f} mm ({:.2f} mm without the net)",
                               *report.validation_rmse_mm, *report.validation_start_rmse_mm);
    Say(fmt::format("{}: {} strokes, best of {} epochs is {}, training RMSE {:.2f} mm{}", out_,
                    report.strokes, report.epochs, report.best_epoch, report.train_rmse_mm,
                    validation));
    WriteResult(json);
    return report.stopped ? 130 : 0;
  }

  // The model that a fit starts from is trained on as it is.
  void TakeModelOf(const std::filesystem::path& init) {
    SurrogateConfig asked = config_.surrogate, standard,
                    own = SurrogateConfigOf(ReadSafetensors(init), init.string());
    const auto json = ToJson(FieldsOf(asked));
    if (json != ToJson(FieldsOf(standard)) && json != ToJson(FieldsOf(own)))
      throw Error("--init " + init.string() +
                  ": its model is trained on as it is; leave the keys surrogate out");
    config_.surrogate = own;
  }

  int TrainPix2Pix() {
    FitPix2PixRequest request{FindStrokeFiles(data_), HeldOut(), {}, seed(), threads(), WatchFile(out_)};
    if (!init_.empty()) request.init = init_;
    const FitPix2PixReport report = FitPix2Pix(pix2pix_, request);
    WriteSafetensors(report.model, out_);
    nlohmann::json json = report.ToJson();
    json["out"] = out_;
    std::string validation;
    if (report.validation_rmse_mm)
      validation = fmt::format(", validation RMSE {:.2f} mm ({:.2f} mm if nothing changes)",
                               *report.validation_rmse_mm, *report.validation_start_rmse_mm);
    Say(fmt::format("{}: {} strokes, best of {} steps is {}{}", out_, report.strokes, report.steps,
                    report.best_step, validation));
    WriteResult(json);
    return report.stopped ? 130 : 0;
  }

  std::vector<std::filesystem::path> HeldOut() const {
    if (validation_.empty()) return {};
    return FindStrokeFiles(validation_);
  }

  int Calibrate() {
    Progress progress("fit", 0, "evaluations", WatchFile(out_));
    Calibration found =
        CalibrateHeightfield(calibration_, FindStrokeFiles(data_), HeldOut(), threads(),
                             [&](int done, double r2_change) {
                               progress.Update(done, "r2_change " + std::to_string(r2_change));
                             });
    FieldList fields;
    fields.Section("heightfield", found.heightfield);
    WriteFileAtomically(out_, ToYaml(fields));
    std::string elsewhere;
    if (found.validation)
      elsewhere = fmt::format(", on other beds {:.4f} (RMSE {:.2f} mm)", found.validation->r2_change,
                              found.validation->rmse_mm);
    Say(fmt::format("{}: r2_change {:.4f} -> {:.4f} in {} evaluations{}", out_,
                    found.start.r2_change, found.fitted.r2_change, found.evaluations, elsewhere));
    nlohmann::json json = found.ToJson();
    json["out"] = out_;
    WriteResult(json);
    return 0;
  }

  bool generates() const { return data_.size() == 1 && data_[0] == "generated"; }

  std::vector<std::string> data_, validation_;
  std::string init_, log_, out_, model_ = "surrogate";
  bool resume_ = false;
  FitConfig config_;
  FitPix2PixConfig pix2pix_;
  CalibrationConfig calibration_;
};

}  // namespace

std::unique_ptr<Command> MakeFitCommand() { return std::make_unique<FitCommand>(); }

}  // namespace sandwright
