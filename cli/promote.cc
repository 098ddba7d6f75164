// sandwright promote: a rig's own sand model takes the place of the old one, if it is provably better.
#include <spdlog/fmt/ranges.h>

#include "cli/command.h"
#include "cli/promotion_curve.h"
#include "cli/score_report.h"
#include "data/base/atomic_file.h"
#include "data/base/error.h"
#include "data/base/stop.h"
#include "data/shipped.h"
#include "data/stroke_dataset.h"
#include "env/load_sand_model.h"
#include "env/model_origin.h"

namespace sandwright {
namespace {

namespace fs = std::filesystem;

class PromoteCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--candidate", candidate_, "the new model (.safetensors)")->required();
    app.add_option("--current", current_, "the model in use: default, or a .safetensors file")
        ->required();
    app.add_option("--data", data_,
                   "strokes of the rig on beds that the candidate has not seen: files or folders")
        ->required();
    app.add_option("--earlier", earlier_, "further models of this rig, for the learning curve");
    app.add_option("--out", out_,
                   "the model in use from now on; the one before stays as NAME.previous.safetensors")
        ->required();
    app.add_option("--floor-mm", score_.floor_mm,
                   "noise floor of the data [mm]; else from its replicates")
        ->check(CLI::NonNegativeNumber);
  }
  void Fields(FieldList& f) override {
    f.Section("score", score_);
    sand_.Fields(f);
  }

  int Run() override {
    const fs::path current = current_ == "default" ? ShippedFile("models/default_surrogate.safetensors")
                                                   : fs::path(current_);
    const std::string old_model = ReadFile(current), new_model = ReadFile(candidate_);
    if (!out_.ends_with(".safetensors"))
      throw Error("--out " + out_ + ": the name of a model must end in .safetensors");
    if (fs::exists(out_) && ReadFile(out_) != old_model)
      throw Error("--out " + out_ + ": another model than --current " + current_ +
                  " lies there: judge the candidate against that, or name another file");
    { const AtomicFile probe(out_); }  // says so before the work where it cannot be written
    const auto files = FindStrokeFiles(data_);
    if (const auto seen = SeenBefore(OriginOf(ReadSafetensors(candidate_), candidate_), files);
        !seen.empty())
      throw Error(candidate_, seen);
    sand_.heightfield.threads = threads();
    const ScoreReport own = Score(candidate_, files), before = Score(current.string(), files);
    const PairedComparison difference =
        CompareExplained(own.strokes, before.strokes, own.floor_mm, seed());
    fmt::print("{}", DescribeComparison(difference, candidate_, current_));
    nlohmann::json result = {{"difference", difference.ToJson()},
                             {"learning_curve", Curve(own, before, files)}};
    if (difference.low95 <= 0) return Refuse(result, difference);

    const fs::path previous = current_ == "default" ? current : fs::path(out_).replace_extension(".previous.safetensors");
    if (previous != current) WriteFileAtomically(previous, old_model);
    WriteFileAtomically(out_, new_model);
    fmt::print("{} is in use as {}; the model before it: {}\n", candidate_, out_, previous.string());
    result.update({{"accepted", true}, {"out", out_}, {"previous", previous.string()}});
    WriteResult(result);
    return 0;
  }

 private:
  ScoreReport Score(const std::string& model, const std::vector<fs::path>& files) const {
    ScoreReport report = ScoreModel(*LoadSandModel(model, sand_), files, score_);
    ThrowIfStopRequested();
    return report;
  }

  // The models that were trained on this rig's strokes; those of `default` are of other sand.
  nlohmann::json Curve(const ScoreReport& own, const ScoreReport& before,
                       const std::vector<fs::path>& files) const {
    PromotionCurve curve(candidate_, own);
    if (current_ != "default") curve.Add(current_, before);
    for (const std::string& model : earlier_) curve.Add(model, Score(model, files));
    fmt::print("{}\n", curve.Describe());
    return curve.ToJson();
  }

  int Refuse(nlohmann::json& result, const PairedComparison& difference) const {
    const std::string reason =
        fmt::format("not provably better than {}: the 95 % interval of the difference in `explained` "
                    "is {:+.4f} to {:+.4f} over {} {}; its lower end must be above 0",
                    current_, difference.low95, difference.high95, difference.units, difference.unit);
    fmt::print("refused: {}\n", reason);
    result.update({{"accepted", false}, {"reasons", {reason}}});
    WriteResult(result);
    return 3;
  }

  std::string candidate_, current_, out_;
  std::vector<std::string> data_, earlier_;
  ScoreConfig score_;
  SandModelConfig sand_;
};

}  // namespace

std::unique_ptr<Command> MakePromoteCommand() { return std::make_unique<PromoteCommand>(); }

}  // namespace sandwright
