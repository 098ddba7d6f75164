// sandwright simulate: strokes on a terrain by a sand model, without arm and without learning.
#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>

#include "cli/command.h"
#include "data/base/error.h"
#include "data/base/stop.h"
#include "data/picture.h"
#include "env/load_sand_model.h"

namespace sandwright {
namespace {

class SimulateCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--model", model_,
                   "sand model: heightfield, dem, none, default, fast or a .safetensors file");
    app.add_option("--terrain", terrain_, "height map file")->required();
    app.add_option("--strokes", strokes_, "strokes (plan) file")->required();
    app.add_option("--out", out_, "height map file to write");
    app.add_option("--picture", picture_,
                   "PNG to write: before, after and change (+-20 mm) side by side");
  }
  void Fields(FieldList& f) override { sand_.Fields(f); }

  int Run() override {
    if (out_.empty() && picture_.empty())
      throw Error("simulate needs --out FILE.h5, --picture FILE.png or both");
    sand_.heightfield.threads = threads();
    const std::unique_ptr<SandModel> model = LoadSandModel(model_, sand_);
    std::vector<SandState> state = {model->Start(ReadHeightMap(terrain_), seed())};
    const HeightMap before = state[0].map();
    nlohmann::json per_stroke = nlohmann::json::array();
    double total_ms = 0;
    for (const Stroke& stroke : ReadStrokes(strokes_)) {
      ThrowIfStopRequested();
      const auto start = std::chrono::steady_clock::now();
      const Outcome outcome = model->Apply(state, std::span<const Stroke>(&stroke, 1))[0];
      total_ms +=
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
              .count();
      per_stroke.push_back({{"moved_volume_cm3", 1e6 * outcome.moved_volume_m3},
                            {"left_box", outcome.left_box},
                            {"below_floor", outcome.below_floor}});
      if (!outcome.training_distance) continue;
      per_stroke.back()["training_distance"] = *outcome.training_distance;
      if (*outcome.training_distance > 1)
        spdlog::warn(
            "stroke {} is beyond what the model was trained on (distance {:.2f}; 1 = the 99th "
            "percentile of the training strokes)",
            per_stroke.size() - 1, *outcome.training_distance);
    }
    const HeightMap& after = state[0].map();
    if (!out_.empty()) WriteHeightMap(after, out_);
    if (!picture_.empty()) Draw(before, after);
    const size_t count = per_stroke.size();
    const double ms_per_stroke = count == 0 ? 0 : total_ms / static_cast<double>(count);
    fmt::print("{} strokes by {}, {:.2f} ms a stroke\n", count, model->name(), ms_per_stroke);
    WriteResult({{"model", model_},
                 {"strokes", count},
                 {"cell_size_m", before.cell_size_m},
                 {"ms_per_stroke", ms_per_stroke},
                 {"per_stroke", per_stroke}});
    return 0;
  }

 private:
  void Draw(const HeightMap& before, const HeightMap& after) const {
    const auto [low, high] = std::ranges::minmax(after.height_m);
    const int scale = std::max(1, 400 / std::max(before.columns, before.rows));
    const cv::Mat parts[] = {DrawHeights(before, low, high, scale),
                             DrawHeights(after, low, high, scale),
                             DrawDifference(after, before, 0.02, scale)};
    cv::Mat row;
    cv::hconcat(parts, 3, row);
    WritePicture(row, picture_);
  }

  SandModelConfig sand_;
  std::string model_ = "heightfield", terrain_, strokes_, out_, picture_;
};

}  // namespace

std::unique_ptr<Command> MakeSimulateCommand() { return std::make_unique<SimulateCommand>(); }

}  // namespace sandwright
