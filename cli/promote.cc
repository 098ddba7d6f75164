// sandwright promote: a rig's own sand model replaces the old one, if it is provably better.
#include <spdlog/fmt/ranges.h>

#include "cli/command.h"
#include "cli/model_replacement.h"
#include "cli/promotion_curve.h"
#include "cli/score_report.h"
#include "data/base/error.h"
#include "data/base/stop.h"
#include "data/stroke_dataset.h"
#include "env/load_sand_model.h"
#include "env/model_origin.h"

namespace sandwright {
namespace {

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
    app.add_option("--out", out_, "the model in use from now on (.safetensors); the one before it "
                                  "stays beside it as NAME.previous.safetensors")
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
    const ModelReplacement replacement(candidate_, current_, out_);
    files_ = FindStrokeFiles(data_);
    const ModelOrigin origin = OriginOf(ReadSafetensors(candidate_), candidate_);
    if (const auto seen = SeenBefore(origin, files_); !seen.empty()) throw Error(candidate_, seen);
    sand_.heightfield.threads = threads();
    const ScoreReport own = Score(candidate_), before = Score(replacement.current().string());
    const PairedComparison difference =
        CompareExplained(own.strokes, before.strokes, own.floor_mm, seed());
    fmt::print("{}", DescribeComparison(difference, candidate_, current_));
    nlohmann::json result = {{"difference", difference.ToJson()}, {"learning_curve", Curve(own, before)}};
    if (difference.low95 <= 0) return Refuse(result, difference);
    replacement.Replace();
    const std::string previous = replacement.previous().string();
    fmt::print("{} is in use as {}; the model before it: {}\n", candidate_, out_, previous);
    result.update({{"accepted", true}, {"out", out_}, {"previous", previous}});
    WriteResult(result);
    return 0;
  }

 private:
  ScoreReport Score(const std::string& model) const {
    ScoreReport report = ScoreModel(*LoadSandModel(model, sand_), files_, score_);
    ThrowIfStopRequested();
    return report;
  }

  // Over the models that were trained on this rig's strokes: those of `default` are of other sand.
  nlohmann::json Curve(const ScoreReport& own, const ScoreReport& before) const {
    PromotionCurve curve(candidate_, own);
    if (current_ != "default") curve.Add(current_, before);
    for (const std::string& model : earlier_) curve.Add(model, Score(model));
    fmt::print("{}\n", curve.Describe());
    return curve.ToJson();
  }

  int Refuse(nlohmann::json& result, const PairedComparison& difference) const {
    const std::string reason = fmt::format(
        "not provably better than {}: the 95 % interval of the difference in `explained` is {:+.4f} to "
        "{:+.4f} over {} {}; its lower end must be above 0",
        current_, difference.low95, difference.high95, difference.units, difference.unit);
    fmt::print("refused: {}\n", reason);
    result.update({{"accepted", false}, {"reasons", {reason}}});
    WriteResult(result);
    return 3;
  }

  std::string candidate_, current_, out_;
  std::vector<std::string> data_, earlier_;
  std::vector<std::filesystem::path> files_;
  ScoreConfig score_;
  SandModelConfig sand_;
};

}  // namespace

std::unique_ptr<Command> MakePromoteCommand() { return std::make_unique<PromoteCommand>(); }

}  // namespace sandwright
