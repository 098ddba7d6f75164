// sandwright plot: learning curves of training runs over their seeds.
#include <spdlog/fmt/fmt.h>

#include <filesystem>

#include "agents/learning_curve.h"
#include "cli/command.h"
#include "cli/svg_chart.h"
#include "data/base/atomic_file.h"
#include "data/base/error.h"

namespace sandwright {
namespace {

constexpr const char* kColours[] = {"#1f5fa8", "#c8502d", "#3f8f4f", "#7a4fa3", "#a8862a", "#555555"};

class PlotCommand final : public Command {
 public:
  void Declare(CLI::App& app) override {
    app.add_option("--runs", runs_,
                   "a curve: NAME=RUNDIR,RUNDIR,... with its seeds' run folders; once for each curve")
        ->required()
        ->allow_extra_args(false);
    app.add_option("--value", column_, "column of progress.csv, e.g. eval/in_goal_mean_diff_mm")
        ->capture_default_str();
    app.add_option("--out", out_, "picture (SVG) to write")->required();
  }

  int Run() override {
    Chart chart{.x_label = "steps", .y_label = column_, .from_zero = false};
    nlohmann::json curves = nlohmann::json::array();
    for (const std::string& argument : runs_) {
      const auto [name, folders] = Parse(argument);
      const LearningCurve curve = ReadLearningCurve(folders, column_, seed());
      chart.series.push_back({.name = fmt::format("{} ({} {})", name, curve.runs,
                                                  curve.runs == 1 ? "seed" : "seeds"),
                              .x = curve.steps,
                              .y = curve.iqm,
                              .low = curve.low95,
                              .high = curve.high95,
                              .colour = kColours[chart.series.size() % std::size(kColours)],
                              .markers = false});
      curves.push_back({{"name", name},
                        {"runs", curve.runs},
                        {"steps", curve.steps},
                        {"iqm", curve.iqm},
                        {"low95", curve.low95},
                        {"high95", curve.high95}});
      fmt::print("{}: {} {:.4g} [{:.4g}, {:.4g}] at step {:.0f}, {} seeds\n", name, column_,
                 curve.iqm.back(), curve.low95.back(), curve.high95.back(), curve.steps.back(),
                 curve.runs);
    }
    WriteFileAtomically(out_, DrawChartFile(chart));
    WriteResult({{"value", column_}, {"curves", curves}});
    return 0;
  }

 private:
  static std::pair<std::string, std::vector<std::filesystem::path>> Parse(
      const std::string& argument) {
    const size_t equals = argument.find('=');
    std::vector<std::filesystem::path> folders;
    for (size_t at = equals; at != std::string::npos && at + 1 < argument.size();) {
      const size_t comma = argument.find(',', at + 1);
      folders.emplace_back(argument.substr(at + 1, comma - at - 1));
      at = comma;
    }
    if (equals == 0 || folders.empty())
      throw Error(fmt::format("--runs {}: allowed: NAME=RUNDIR,RUNDIR,...", argument));
    return {argument.substr(0, equals), folders};
  }

  std::vector<std::string> runs_;
  std::string column_ = "eval/in_goal_mean_diff_mm", out_;
};

}  // namespace

std::unique_ptr<Command> MakePlotCommand() { return std::make_unique<PlotCommand>(); }

}  // namespace sandwright
